//! The program: arguments → settings → app → exit code.

fn main() {}
