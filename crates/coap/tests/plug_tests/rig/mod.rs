//! The rig of the endpoint's tests: a bench for datagrams by hand, and a scene of honest clients on a bad network.
//! Everything runs in simulated time; a failure prints its seed. No case is tested here.

pub(crate) mod bench;
pub(crate) mod chance;
pub(crate) mod client;
pub(crate) mod message;
pub(crate) mod network;
pub(crate) mod scene;
pub(crate) mod server;

/// Prints the seed when the test that holds it fails.
struct Seed(u64);

impl Drop for Seed {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("seed {}", self.0);
        }
    }
}

pub(crate) fn each_seed(seeds: u64, run: impl Fn(u64)) {
    for seed in 0..seeds {
        let shown = Seed(seed);
        run(seed);
        drop(shown);
    }
}
