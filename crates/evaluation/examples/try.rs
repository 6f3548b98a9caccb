#![allow(clippy::all, clippy::pedantic, clippy::print_stdout, clippy::disallowed_methods)]
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;
use hallsweep_core::search::{Objective, Strategy};
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::{Ground, Walk};
fn main() {
    let mut pocket = Weights::nothing();
    pocket.linear[0] = 2500;
    pocket.linear[1] = 2500;
    pocket.linear[2] = 5000;
    let mut ways = Ways::default();
    for (name, family, w, h) in [
        ("empty", Family::Luggage(0.0), 10, 8),
        ("20 10%", Family::Luggage(0.1), 20, 20),
        ("5%", Family::Luggage(0.05), 50, 50),
        ("10%", Family::Luggage(0.1), 50, 50),
        ("20%", Family::Luggage(0.2), 50, 50),
        ("walls", Family::Walls, 50, 50),
        ("islands", Family::Islands, 50, 50),
        ("maze", Family::Maze, 51, 51),
        ("pockets", Family::Pockets, 50, 50),
    ] {
        let _ = &pocket;
        for strategy in [Strategy::Scored, Strategy::Frontier, Strategy::Columns, Strategy::Spiral, Strategy::Snail] {
            let policy = strategy.name();
            let mut sum = 0.0;
            let mut n = 0;
            let mut find = 0.0;
            let mut sonar = 0.0;
            let mut parts = [0.0; 3];
            let t = std::time::Instant::now();
            let mut moves = 0;
            for seed in 0..60 {
                let mut dice = RandomStream::new(seed, "try");
                let ground = Ground::of(&hall(family, w, h, &mut dice));
                if ground.reachable < w * h / 3 {
                    continue;
                }
                let walk = Walk::search(&ground, 0, &mut ways, Costs::EVEN, Objective::Cover, strategy.begin());
                assert_eq!((walk.visited, walk.touched), (ground.reachable, ground.touchable));
                moves += walk.total();
                sum += walk.total() as f64 / ground.reachable as f64;
                for i in 0..3 {
                    parts[i] += walk.moves[i] as f64 / ground.reachable as f64;
                }
                find += walk.touch_sum as f64 / walk.touched.max(1) as f64 / ground.reachable as f64;
                n += 1;
            }
            let us = t.elapsed().as_secs_f64() * 1e6 / moves as f64;
            for seed in 0..60 {
                let mut dice = RandomStream::new(seed, "try");
                let ground = Ground::of(&hall(family, w, h, &mut dice));
                if ground.reachable < w * h / 3 {
                    continue;
                }
                let walk = Walk::search(&ground, 1, &mut ways, Costs::EVEN, Objective::Cover, strategy.begin());
                assert_eq!((walk.visited, walk.touched), (ground.reachable, ground.touchable));
                sonar += walk.total() as f64 / ground.reachable as f64;
            }
            let n = n as f64;
            println!(
                "{name} {policy}: {:.3} find {:.3} sonar {:.3} ({:.3} {:.3} {:.3})  {us:.2} us/move",
                sum / n,
                find / n,
                sonar / n,
                parts[0] / n,
                parts[1] / n,
                parts[2] / n
            );
        }
    }
}
