//! Files of behaviour trees: any text is refused with a place and a sentence, or is printed as the same document. A
//! tree that can be built can be ticked and halted, and resumed from its printed state, with leaves that return every
//! status.
#![no_main]

use std::time::Duration;

use hallsweep_fuzz::behaviour_trees::{Blackboard, Catalogue, Document, Findings, Mocks, Status, Tree, TreeError, TreeState, xml};
use libfuzzer_sys::fuzz_target;

/// Longest refusal in bytes. It quotes a few words of the file, but a quoted attribute can be as long as the input.
const SENTENCE: usize = 64 * 1024;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match xml::read(text) {
        Err(error) => {
            said(&error);
            let mut findings = Findings::default();
            if let Some(document) = xml::read_with(text, &mut findings) {
                document.check(&Catalogue::default(), &mut findings);
            }
            findings.faults().into_iter().chain(findings.notes()).for_each(said);
        }
        Ok(document) => {
            let written = xml::write(&document);
            assert_eq!(xml::read(&written).expect("what is written can be read"), document);
            run(&document);
        }
    }
});

fn said(error: &TreeError) {
    let said = error.to_string();
    assert!(error.place.line >= 1 && error.place.column >= 1, "{said}");
    assert!((8..SENTENCE).contains(&said.len()), "{said}");
}

fn run(document: &Document) {
    let mut mocks = Mocks::default();
    mocks.add("*=RUNNING*2,SUCCESS,SKIPPED,RUNNING,FAILURE,SUCCESS").expect("it is well written");
    let catalogue = mocks.catalogue(document, Catalogue::default());
    let mut findings = Findings::default();
    document.check(&catalogue, &mut findings);
    findings.faults().into_iter().chain(findings.notes()).for_each(said);
    let mut blackboard = Blackboard::new();
    let Ok(mut tree) = Tree::build(document, None, &catalogue, &mut blackboard) else { return };
    for _ in 0..8 {
        let ticked = tree.tick(&mut blackboard, &mut mocks, Duration::from_millis(100));
        assert_ne!(ticked, Ok(Status::Idle));
    }
    let kept: TreeState = tree.state().to_string().parse().expect("a written state can be read");
    assert_eq!(kept, tree.state());
    tree.resume(kept).expect("it is the same tree");
    tree.halt(&mut blackboard, &mut mocks);
    assert!(tree.nodes().all(|node| node.after == Status::Idle));
}
