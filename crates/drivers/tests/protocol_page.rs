//! Checks the page about the line protocol: every line that it shows is valid, and its numbers are ours.

use hallsweep_drivers::line::{FromRobot, LineReader, MOST_BYTES, RobotName, Seq, ToRobot, framed};

const PAGE: &str = include_str!("../../../docs/robot-line-protocol.md");

/// Examples for the page's words in capitals.
const EXAMPLES: [(&str, &str); 13] = [
    ("X,Y,HEADING", "-3,12,west"),
    ("PART…", "base led"),
    ("NAME", "ada"),
    ("OBSTACLE", "wall 3 2"),
    ("LENGTH", "18211"),
    ("CELLS", "3"),
    ("WORDS", "the camera does not answer"),
    ("DEGREES", "21.5"),
    ("CRC", "CBF43926"),
    ("SEQ", "42"),
    ("CM", "37"),
    ("MS", "1990"),
    ("PIECE", "5"),
];

/// The lines in the first column of the table under this heading, with examples for what they leave open.
fn lines(heading: &str) -> Vec<String> {
    let section = PAGE.split("\n## ").find_map(|section| section.strip_prefix(heading)).expect("the page has this heading");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let spans = cells.flat_map(|cell| cell.trim_end_matches('`').split("` `")).map(str::to_owned);
    spans.map(|span| EXAMPLES.iter().fold(span, |span, (word, example)| span.replace(word, example))).collect()
}

#[test]
fn every_line_of_the_page_is_one_and_is_written_as_there() {
    let (said, heard) = (lines("What the program says\n"), lines("What the robot says\n"));
    assert_eq!((said.len(), heard.len()), (11, 13), "{said:?} {heard:?}");
    for line in said {
        assert_eq!(ToRobot::parse(&line).map(|words| words.to_string()), Some(line));
    }
    for line in heard {
        assert_eq!(FromRobot::parse(&line).map(|words| words.to_string()), Some(line));
    }
}

#[test]
fn the_checked_line_of_the_page_is_a_good_one() {
    let mut reader = LineReader::default();
    let line = PAGE.split('`').find(|span| span.starts_with("w 7 1990*")).expect("it is there");
    let text = format!("{line}\r\n").bytes().find_map(|byte| reader.take(byte));
    assert_eq!(text.as_deref(), Some("w 7 1990"));
    assert_eq!(framed("123456789"), b"123456789*29B1\n");
}

#[test]
fn the_numbers_of_the_page_are_ours() {
    for words in [
        format!("from 1 to {}", Seq::LAST.number()),
        format!("at most {MOST_BYTES}"),
        format!("NAME has 1 to {} letters", RobotName::MOST),
        format!("at most 40 bytes, one of the robot at most {}", hallsweep_drivers::line::LONGEST),
    ] {
        assert!(PAGE.contains(&words), "{words}");
    }
}
