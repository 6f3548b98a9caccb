//! Tests of the pallet scenario.

use super::*;

#[test]
fn one_parcel_arrives() {
    let mut run = PalletRun::new(2, 1, Asked::default()).unwrap();
    let figures = run.finish();
    println!("{}", run.yard.hall.name());
    for entry in run.entries() {
        println!("{:?} {} {:?}", entry.at, entry.parcel, entry.news);
    }
    println!("{figures:?} {:?} {:?}", run.team.words(), run.team.stage());
    assert_eq!(figures.fault, None);
}
