#![allow(clippy::all, clippy::pedantic, clippy::print_stdout, clippy::disallowed_methods)]
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::*;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::{Ground, Walk};
fn main() {
    for n in [100usize, 400, 1000] {
        for strategy in [Strategy::Auto, Strategy::Frontier] {
            let mut dice = RandomStream::new(5, "worst");
            let ground = Ground::of(&hall(Family::Luggage(0.1), n, n, &mut dice));
            let mut ways = Ways::default();
            let mut walk = Walk::new(&ground, 0);
            let mut search = strategy.begin();
            let (mut worst, mut sum, mut count) = (0.0f64, 0.0, 0);
            let t0 = std::time::Instant::now();
            let mut times = vec![];
            loop {
                let t = std::time::Instant::now();
                let next = search.next(&walk.view(Costs::EVEN, Objective::Cover), &mut ways);
                let us = t.elapsed().as_secs_f64() * 1e6;
                worst = worst.max(us);
                sum += us;
                count += 1;
                times.push(us);
                match next {
                    NextGoal::Visit(cell, route) => walk.enter(&ground, &(cell, route)),
                    _ => break,
                }
            }
            let t = std::time::Instant::now();
            walk.go_home(&ground, &mut ways, Costs::EVEN);
            let home = t.elapsed().as_secs_f64() * 1e3;
            times.sort_by(|a, b| b.total_cmp(a));
            println!(
                "{n} {}: {count} decisions, mean {:.2} us, worst {:.2} ms (next {:?}), home {home:.2} ms, whole {:.2} s, {:.2} us a move, moves/C {:.3}",
                strategy.name(),
                sum / count as f64,
                worst / 1e3,
                &times[1..4],
                t0.elapsed().as_secs_f64(),
                t0.elapsed().as_secs_f64() * 1e6 / walk.total() as f64,
                walk.total() as f64 / ground.reachable as f64
            );
        }
    }
}
