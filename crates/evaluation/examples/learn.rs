#![allow(clippy::all, clippy::pedantic, clippy::print_stdout, clippy::disallowed_methods)]
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::outlook::LINEAR_NAMES;
use hallsweep_core::search::weights::Weights;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::tune::*;
use hallsweep_evaluation::walk::{Ground, Walk};
static MIX: &[(u64, Family)] = &[(100, Family::Luggage(0.1))];
fn test(task: &Task, weights: &Weights) -> String {
    let mut out = String::new();
    for (name, family, w, h) in [
        ("50:10%", Family::Luggage(0.1), 50, 50),
        ("20:10%", Family::Luggage(0.1), 20, 20),
        ("5%", Family::Luggage(0.05), 50, 50),
        ("20%", Family::Luggage(0.2), 50, 50),
        ("walls", Family::Walls, 50, 50),
        ("islands", Family::Islands, 50, 50),
    ] {
        let prices = parallel(60, 2, |n, ways| {
            let mut dice = RandomStream::new(n as u64, "try");
            loop {
                let ground = Ground::of(&hall(family, w, h, &mut dice));
                if ground.reachable < w * h / 3 {
                    continue;
                }
                let walk = Walk::run(&ground, task.sonar, ways, task.costs, weights);
                assert_eq!((walk.visited, walk.touched), (ground.reachable, ground.touchable));
                return if task.find {
                    walk.touch_sum as f64 / walk.touched.max(1) as f64 / ground.reachable as f64
                } else {
                    task.price(&ground, &walk)
                };
            }
        });
        let (m, d) = mean(&prices);
        out += &format!("{name} {m:.3}±{d:.3} ");
    }
    out
}
fn save(path: &str, w: &Weights) {
    let text = w.linear.iter().map(|x| x.to_string()).chain(w.rows.iter().map(|x| x.to_string())).collect::<Vec<_>>().join("\n");
    std::fs::write(path, text).unwrap();
}
fn load(path: &str) -> Option<Weights> {
    let text = std::fs::read_to_string(path).ok()?;
    let mut w = Weights::nothing();
    let n: Vec<i32> = text.lines().map(|l| l.parse().unwrap()).collect();
    for i in 0..w.linear.len() {
        w.linear[i] = n[i];
    }
    for i in 0..w.rows.len() {
        w.rows[i] = n[w.linear.len() + i] as i16;
    }
    w.least = -3000;
    Some(w)
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let find = args[1] == "find";
    let sonar: u8 = args[2].parse().unwrap();
    let file = &args[3];
    let (halls, horizon, tried, ridge, rounds): (usize, f64, u64, f64, usize) = (
        args[4].parse().unwrap(),
        args[5].parse().unwrap(),
        args[6].parse().unwrap(),
        args[7].parse().unwrap(),
        args[8].parse().unwrap(),
    );
    let seed: u64 = args[9].parse().unwrap();
    let task = Task { find, sonar, costs: Costs::EVEN, side: (20, 30), mix: MIX };
    let t = std::time::Instant::now();
    let mut w = load(file).unwrap_or_else(|| {
        let mut start = Weights::nothing();
        start.least = -3000;
        if !find {
            start.linear[0] = 2500;
            start.linear[1] = 2500;
            start.linear[2] = 5000;
        }
        println!("start {}", test(&task, &start));
        let w = cross_entropy(&task, &start, 30, seed, |g, p| {
            if g % 5 == 4 {
                println!("  {g}: {p:.4}")
            }
        });
        println!("cross-entropy {:.0} s: {}", t.elapsed().as_secs_f64(), test(&task, &w));
        save(file, &w);
        w
    });
    for (n, x) in LINEAR_NAMES.iter().zip(w.linear) {
        print!("{n} {:.2}  ", x as f64 / 1000.0);
    }
    println!("\nloaded {}", test(&task, &w));
    let mut value = Vec::new();
    let mut kept = Vec::new();
    let every: usize = args.get(10).map_or(3, |s| s.parse().unwrap());
    for r in 0..rounds {
        if r % every == 0 {
            value = value_of(&task, &w, halls.max(3000), seed * 7919 + r as u64);
            println!("value {:.0} s {:.1?}", t.elapsed().as_secs_f64(), &value[..20]);
        }
        let round = Round { halls, seed: seed * 104729 + r as u64, horizon, tried, ridge, taken: if r == 0 { 0.9 } else { 0.7 } };
        let fit = regress(&task, &round, &w, &value, &mut kept);
        w = fit.weights;
        println!(
            "round {r} {:.0} s: {} samples, {:.2?}; {}",
            t.elapsed().as_secs_f64(),
            fit.samples,
            fit.missed,
            test(&task, &w)
        );
        save(file, &w);
    }
}
