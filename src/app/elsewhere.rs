//! Moves the robot to a hall that differs from the recorded hall. First the journal stores the move, then the robot's
//! state file is started anew. If the program is killed in between, the robot and the map are still in the same hall.
//! `data_folder` decides when a move is needed.

use std::time::Duration;

use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::link::RobotLink;
use crate::runtime::store::Store;
use hallsweep_core::effect::Effect;
use hallsweep_core::engine::Engine;
use hallsweep_core::event::Event;
use hallsweep_core::units::Seq;

/// Maximum wait for the disk. After this time the program runs without a state file, and the next start tries again.
const KEPT_WITHIN: Duration = Duration::from_secs(5);

pub(super) async fn put_down(
    engine: &mut Engine,
    store: &mut dyn Store,
    link: &RobotLink,
    halter: &Halter,
    clock: &Clock,
) -> bool {
    engine.put_down_elsewhere(clock.now());
    let mut word = store.word();
    let losses = word.borrow().losses;
    let last = hand_over(engine, store, link, halter, losses);
    let settled = word.wait_for(|word| word.kept >= last || word.losses > losses || word.failure.is_some());
    let is_settled = matches!(tokio::time::timeout(KEPT_WITHIN, settled).await, Ok(Ok(_)));
    let kept = word.borrow().kept;
    engine.handle_event(Event::Recorded(kept), clock.now());
    let is_kept = is_settled && kept >= last;
    if !is_kept {
        tracing::warn!("the move of the robot to another hall could not be recorded: the next start tries again");
    }
    is_kept
}

/// Hands all pages of the engine to the store; returns the number of the last entry. No robot is linked yet and no
/// command was sent. So besides pages, the only effects are halts and changes of the LED.
fn hand_over(engine: &mut Engine, store: &mut dyn Store, link: &RobotLink, halter: &Halter, losses: u64) -> Seq {
    let mut last = Seq(0);
    while let Some(effect) = engine.poll_effect() {
        match effect {
            Effect::Record(page) => {
                last = page.last();
                store.record(page, losses);
            }
            Effect::Halt(_) => halter.halt(),
            Effect::Led(_, blinks) => drop(link.led.send_replace(blinks)),
            Effect::Order(..) | Effect::Answer(..) => {}
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use tokio::sync::watch;

    use super::*;
    use crate::runtime::link::link;
    use crate::runtime::store::StoreStatus;
    use hallsweep_core::effect::Page;
    use hallsweep_core::settings::Settings;
    use hallsweep_core::units::Epoch;

    struct Slow {
        word: watch::Sender<StoreStatus>,
        pages: Vec<Page>,
    }

    impl Store for Slow {
        fn record(&mut self, page: Page, _: u64) {
            self.pages.push(page);
        }

        fn word(&self) -> watch::Receiver<StoreStatus> {
            self.word.subscribe()
        }
    }

    async fn put_down_with(say: impl FnOnce(&mut StoreStatus) + Send + 'static) -> (bool, Engine, Slow) {
        let mut engine = Engine::new(Settings::default(), Default::default(), "test".into());
        let mut store = Slow { word: watch::Sender::default(), pages: Vec::new() };
        let word = store.word.clone();
        tokio::spawn(async move {
            tokio::time::sleep(KEPT_WITHIN / 2).await;
            word.send_modify(say);
        });
        let halter = Halter::new(Epoch(0));
        let (link, _side) = link(halter.watch());
        let kept = put_down(&mut engine, &mut store, &link, &halter, &Clock::default()).await;
        (kept, engine, store)
    }

    /// Safety R1, R2.
    #[tokio::test(start_paused = true)]
    async fn it_is_done_when_all_of_it_is_on_record() {
        let (kept, mut engine, store) = put_down_with(|word| word.kept = Seq(100)).await;
        assert!(kept);
        assert!(!store.pages.is_empty(), "there was something to keep");
        assert!(engine.poll_effect().is_none(), "the loop finds nothing that was left behind");
    }

    #[tokio::test(start_paused = true)]
    async fn a_disk_that_fails_or_hangs_gives_no_state_file() {
        assert!(!put_down_with(|_| {}).await.0, "it says nothing");
        assert!(!put_down_with(|word| word.kept = Seq(0)).await.0, "it keeps nothing");
        let fails = |word: &mut StoreStatus| (word.losses, word.failure) = (1, Some("the disk is full".into()));
        assert!(!put_down_with(fails).await.0);
    }
}
