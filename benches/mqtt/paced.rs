//! Single messages at a constant pace far below the capacity of any server: the time of each from the publisher to
//! the subscriber.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::frame;
use crate::load::LENGTH;
use crate::wire::Wire;

/// Interval between messages: 500 per second.
const PACE: Duration = Duration::from_millis(2);

const TOPIC: &str = "bench/paced";

/// Time after which a message counts as lost.
const PATIENCE: Duration = Duration::from_secs(1);

/// Latencies of the messages in ascending order, without those that were lost.
pub(crate) fn run(server: SocketAddr, qos: u8, messages: usize) -> std::io::Result<Vec<Duration>> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let mut took = runtime.block_on(turn(server, qos, messages))?;
    took.sort_unstable();
    Ok(took)
}

async fn turn(server: SocketAddr, qos: u8, messages: usize) -> std::io::Result<Vec<Duration>> {
    let mut subscriber = Wire::connect(server, "subscriber").await?;
    subscriber.subscribe(TOPIC, qos).await?;
    let mut publisher = Wire::connect(server, "publisher").await?;
    let mut paced = tokio::time::interval(PACE);
    let (mut sent, mut took) = (Vec::new(), Vec::new());
    let over = tokio::time::Instant::now() + PACE * messages as u32 + PATIENCE;
    while took.len() < messages {
        tokio::select! {
            biased;
            read = subscriber.read() => {
                read?;
                hear(&mut subscriber, &sent, &mut took).await?;
            }
            read = publisher.read(), if qos > 0 => {
                read?;
                while publisher.next().is_some() {}
            }
            _ = paced.tick(), if sent.len() < messages => {
                let mut out = Vec::new();
                frame::publish(&mut out, TOPIC, qos, sent.len() as u16 + 1, sent.len() as u64, LENGTH);
                sent.push(Instant::now());
                publisher.write(&out).await?;
            }
            () = tokio::time::sleep_until(over) => break,
        }
    }
    Ok(took)
}

/// Records the latencies of the messages received, and acknowledges them.
async fn hear(subscriber: &mut Wire, sent: &[Instant], took: &mut Vec<Duration>) -> std::io::Result<()> {
    let now = Instant::now();
    let mut acknowledgements = Vec::new();
    while let Some((first, body)) = subscriber.next() {
        if first >> 4 != frame::PUBLISH {
            continue;
        }
        let (id, sequence) = frame::published(first, body);
        took.push(now - sent[sequence as usize]);
        if let Some(id) = id {
            frame::puback(&mut acknowledgements, id);
        }
    }
    subscriber.write(&acknowledgements).await
}
