//! Tests of the meaning of old messages. The tests of `message` cover parsing.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::super::reader::LENGTH;
use super::*;
use hallsweep_core::command::{Move, TemperatureReport};
use hallsweep_core::units::Cell;

fn ask(text: &str) -> Result<QakRequest, Wrong> {
    asked(text.as_bytes(), true)
}

/// Reads a message as an event and as a dispatch to the robot's mind. Both must have the same command, which is
/// returned.
fn both(id: &str, content: &str) -> Command {
    let asked = both_ask(id, content);
    let QakRequest::Command(command) = asked else { panic!("{id}: {asked:?}") };
    command
}

fn both_ask(id: &str, content: &str) -> QakRequest {
    let event = ask(&format!("msg({id},event,js,none,{content},1)"));
    let dispatch = ask(&format!("msg({id},dispatch,js,robotmind,{content},1)"));
    assert_eq!(event, dispatch, "{id}");
    let mind = ask(&format!("msg({id},dispatch,js,robotmindapplication,{content},1)"));
    assert_eq!(event, mind, "{id}");
    event.unwrap_or_else(|wrong| panic!("{id}: {wrong}"))
}

#[test]
fn every_message_of_the_original_system_is_a_command_as_event_and_as_dispatch() {
    let mut cases = vec![
        ("startCmd", "startCmd", Command::Start),
        ("stopCmd", "stopCmd", Command::Stop),
        ("backHomeCmd", "backHomeCmd", Command::BackHome),
        ("temperatureOk", "temperatureOk", Command::Temperature(TemperatureReport::Ok)),
        ("temperatureTooHigh", "temperatureTooHigh", Command::Temperature(TemperatureReport::TooHigh)),
        ("luggageSafe", "luggageSafe", SAFE),
        ("luggageDanger", "luggageDanger", DANGER),
        ("explore", "explore(go)", Command::Start),
        ("stopExplore", "stopExplore(now)", Command::Stop),
        ("backHome", "backHome(X)", Command::BackHome),
        ("continueExploreAfterPhoto", "continueExploreAfterPhoto", SAFE),
        ("backHomeSinceBomb", "backHomeSinceBomb(X)", DANGER),
        ("startTest", "startTest(0,8)", Command::Goto(Cell::new(0, 8))),
        ("userCmd", "userCmd(w)", Command::Move(Move::Forward)),
        ("userCmd", "userCmd(stop)", Command::Stop),
        ("robotCmd", "robotCmd(l)", Command::Move(Move::TurnLeft)),
        ("modelChange", "modelChange(robot,h)", Command::Stop),
        ("modelChange", "modelChange(robot,stop)", Command::Stop),
        ("modelChange", "modelChange(robot, w)", Command::Move(Move::Forward)),
        ("modelChange", "modelChange(luggage, safe)", SAFE),
        ("modelChange", "modelChange(luggage,danger)", DANGER),
        ("startAppl", "startAppl(go)", Command::Start),
        ("stopAppl", "stopAppl(go)", Command::Stop),
        ("reachBag", "reachBag", Command::Retrieve(None)),
        ("reachBag", "reachBag(X)", Command::Retrieve(None)),
    ];
    for (id, content, command) in &cases {
        assert_eq!(both(id, content), *command, "{id}");
        assert_eq!(both(id, &format!("'{content}'")), *command, "{id} in quotes");
    }
    cases.dedup_by_key(|case| case.0);
    let tried = cases.iter().map(|case| case.0);
    let known: BTreeSet<&str> = every().map(|known| known.id).filter(|id| *id != GO_ON).collect();
    assert_eq!(known, tried.collect(), "every row of the table is among them");
    for content in [GO_ON, "continueExplore(X)", "'continueExplore'"] {
        assert_eq!(both_ask(GO_ON, content), QakRequest::GoOn);
    }
}

/// A message whose command depends on the state.
const GO_ON: &str = "continueExplore";

#[test]
fn sender_and_number_mean_nothing_and_a_request_is_as_good() {
    for text in [
        "msg(startCmd,request,somebody,hallsweep,startCmd,0)",
        "msg(startCmd,invitation,'the operator',none,startCmd,99)",
        " msg( startCmd , event , js , none , startCmd( ) , 1 ) \n",
    ] {
        assert_eq!(ask(text), Ok(QakRequest::Command(Command::Start)), "{text}");
    }
}

#[test]
fn what_we_say_ourselves_is_nothing_and_what_others_say_is_unknown() {
    let map = "X ".repeat(LENGTH);
    for text in [
        "msg(modelContent,event,resourcemodel,none,content(robot(state(stopped))),7)".to_owned(),
        format!("msg(modelContent,event,resourcemodel,none,content(roomMap(state('{map}'))),8)"),
        "msg(startCmd,reply,a,b,startCmd,1)".to_owned(),
    ] {
        assert_eq!(ask(&text), Ok(QakRequest::Nothing), "{}", in_short(&text));
    }
    for (text, id) in [
        ("msg(sonarRobot,event,sonar,none,sonar(12),1)", "sonarRobot"),
        ("msg(moved,event,a,none,[a|B],1)", "moved"),
        ("msg('modelUpdate', dispatch, a, b, oops", "modelUpdate"),
        ("msg('12',event,a,none,a,1)", "12"),
    ] {
        assert_eq!(ask(text), Ok(QakRequest::Unknown(id.to_owned())), "{text}");
    }
}

#[test]
fn a_known_message_with_nonsense_in_it_is_told_what_is_wrong() {
    let unusable = [
        ("msg(startCmd,event,js,none,stopCmd,1)", "the CONTENT of startCmd is wrong: expected startCmd, found stopCmd"),
        ("msg(luggageSafe,event,js,none,1,1)", "the CONTENT of luggageSafe is wrong: expected luggageSafe, found 1"),
        (
            "msg(startTest,event,js,none,startTest(1),1)",
            "the CONTENT of startTest is wrong: expected startTest(X,Y) with two whole numbers, found startTest(1)",
        ),
        (
            "msg(startTest,event,js,none,startTest(1,2.5),1)",
            "the CONTENT of startTest is wrong: expected startTest(X,Y) with two whole numbers, found startTest(1,2.5)",
        ),
        (
            "msg(startTest,event,js,none,startTest(1,9000),1)",
            "the CONTENT of startTest is wrong: (1, 9000) is out of reach: x and y must be between -8192 and 8192",
        ),
        (
            "msg(userCmd,event,js,none,userCmd,1)",
            "the CONTENT of userCmd is wrong: expected userCmd(w) or another move, found userCmd",
        ),
        (
            "msg(userCmd,event,js,none,userCmd(q),1)",
            "the CONTENT of userCmd is wrong: \"q\" is no move: w forward, s backward, a or l left, d or r right, z and x small turns, h stop",
        ),
        (
            "msg(modelChange,dispatch,js,resourcemodel,modelChange(luggage,bomb),1)",
            "the CONTENT of modelChange is wrong: expected modelChange(robot,w) or another move, modelChange(luggage,safe) or modelChange(luggage,danger), found modelChange(luggage,bomb)",
        ),
    ];
    for (text, words) in unusable {
        let wrong = ask(text).unwrap_err();
        assert_eq!((wrong.to_string().as_str(), wrong.refused().code()), (words, "unusable"));
    }
    for text in
        ["", "startCmd", "msg(startCmd,event,js,none,startCmd)", "{\"id\":1}", &format!("msg(startCmd,{}", "x".repeat(LENGTH))]
    {
        let wrong = ask(text).unwrap_err();
        assert_eq!((wrong.refused().code(), wrong.asked().to_string().as_str()), ("malformed", "a message"), "{wrong}");
    }
}

/// Safety S1.
#[test]
fn nothing_that_is_wrong_with_a_stop_keeps_it_from_halting() {
    let long = "x".repeat(2 * LENGTH);
    for text in [
        "msg(stopCmd,event,js,none,stopCmd,1)",
        "msg(stopCmd,event,js,none,startCmd,1)",
        "msg(stopCmd,shout,7,,[|],-1) and more",
        "msg(stopCmd",
        " msg ( 'stopCmd' , reply",
        &format!("msg(stopExplore,event,js,none,stopExplore({long}),1)"),
        "msg(userCmd,dispatch,js,robotmind,userCmd(h),1)",
        "msg(robotCmd,dispatch,js,robotactuator, robotCmd( 'h' ), one)",
        "msg(userCmd,dispatch,js,robotmind,'robotCmd(h)'",
        &format!("msg(userCmd,dispatch,{long},robotmind,userCmd(h),1)"),
        "msg(userCmd,dispatch,js,robotmind,userCmd(h",
        "msg(userCmd,dispatch,js,robotmind,userCmd(stop),1)",
        "msg(userCmd,dispatch,js,robotmind,userCmd(w),userCmd(h))",
        "msg(robotCmd,event,js,none,'robotCmd( stop )',one)",
        "msg(modelChange,dispatch,js,resourcemodel,modelChange(robot, h),1)",
        "msg(modelChange,shout,js,,'modelChange( robot , \'h\' ) and more",
        "msg(modelChange,dispatch,js,resourcemodel,modelChange(robot,h,now),1)",
        "msg(stopAppl,dispatch,js,robotmindapplication,stopAppl(go),1)",
        "msg(stopAppl,event,js,none,startAppl(go),1)",
        "msg(stopAppl",
        "msg(robotCmd,dispatch,js,robotmind,robotCmd(\"stop\"),1)",
        "msg(userCmd,dispatch,js,robotmind,\"userCmd('h')\",1)",
        "\"msg(modelChange,dispatch,js,resourcemodel,modelChange(\"robot\", \"H\"),1)\"",
        "msg(\"stopCmd\",event,js,none,stopCmd,1)",
    ] {
        assert!(is_stop(text.as_bytes()), "{}", in_short(text));
        assert_eq!(asked(text.as_bytes(), false), Ok(QakRequest::Command(Command::Stop)), "{}", in_short(text));
    }
    let torn = b"msg(stopCmd,event,\xff\xfe\x00";
    assert_eq!(asked(torn, false), Ok(QakRequest::Command(Command::Stop)));
}

#[test]
fn only_a_stop_is_one() {
    for text in [
        "",
        "msg(",
        "stopCmd",
        "msg(stopCmd2,event,js,none,stopCmd,1)",
        "msg(startCmd,event,js,none,stopCmd,1)",
        "msg(userCmd,dispatch,js,robotmind,userCmd(w),1)",
        "msg(startTest,dispatch,js,robotmind,userCmd(h),1)",
        "msg(userCmd,dispatch,js,robotmind,userCmd(halt),1)",
        "msg(modelChange,dispatch,js,resourcemodel,modelChange(robot,w),1)",
        "msg(modelChange,dispatch,js,resourcemodel,modelChange(luggage,h),1)",
        "msg(modelChange,dispatch,js,resourcemodel,modelChange(luggage,safe),1)",
        "msg(startAppl,event,js,none,stopAppl(go),1)",
        "msg(robotCmd,dispatch,js,robotmind,robotCmd(\"w\"),1)",
        "msg(\"startCmd\",event,js,none,\"stopCmd\",1)",
    ] {
        assert!(!is_stop(text.as_bytes()), "{text}");
    }
}

/// Safety S2: a report of heat halts the robot, so its CONTENT is not checked.
#[test]
fn heat_is_believed_whatever_its_message_says() {
    for content in ["temperatureTooHigh(31)", "31", "ok"] {
        assert_eq!(both("temperatureTooHigh", content), Command::Temperature(TemperatureReport::TooHigh), "{content}");
    }
}

#[test]
fn driving_is_for_those_who_were_let_in() {
    for (text, words) in [
        ("msg(userCmd,dispatch,js,robotmind,userCmd(w),1)", "move forward"),
        ("msg(robotCmd,dispatch,js,robotmind,robotCmd(x),1)", "move a little right"),
        ("msg(modelChange,dispatch,js,resourcemodel,modelChange(robot,s),1)", "move backward"),
        ("msg(startTest,dispatch,js,robotmind,startTest(1,2),1)", "goto (1, 2)"),
    ] {
        let wrong = asked(text.as_bytes(), false).unwrap_err();
        assert_eq!((wrong.refused().code(), wrong.asked().to_string().as_str()), ("notAllowed", words));
    }
    let danger = "msg(luggageDanger,event,js,none,luggageDanger,1)";
    assert_eq!(asked(danger.as_bytes(), false), Ok(QakRequest::Command(DANGER)));
}

proptest! {
    /// Safety A7, S1.
    #[test]
    fn whatever_comes_is_taken_or_said_to_be_wrong(
        payload in prop_oneof![prop::collection::vec(any::<u8>(), 0..64), "msg\\((userCmd|stopCmd|startTest|x),[a-z(),' h0-9]{0,40}".prop_map(String::into_bytes)],
        manual_driving in any::<bool>(),
    ) {
        let asked = asked(&payload, manual_driving);
        prop_assert_eq!(is_stop(&payload), asked == Ok(QakRequest::Command(Command::Stop)));
    }
}

/// Safety S1, S8.
#[test]
fn what_an_editor_or_a_socket_puts_before_a_stop_does_not_keep_it_from_halting() {
    for before in ["\u{feff}", "\0", "\r\n", "\u{feff}\0 "] {
        assert!(is_stop(format!("{before}msg(stopCmd").as_bytes()), "{before:?}");
        assert_eq!(ask(&format!("{before}msg(stopCmd,event,js,none,stopCmd,1)")), Ok(QakRequest::Command(Command::Stop)));
    }
}

/// Safety S1, S8.
#[test]
fn whatever_message_can_be_a_move_halts_although_its_end_is_missing() {
    let beginning = |Known { id, asks }: Known| match asks {
        Asks::Move => Some(format!("msg({id},event,js,none,{id}(")),
        Asks::Change => Some(format!("msg({id},event,js,none,{id}(robot,")),
        Asks::For(_) | Asks::Halt(_) | Asks::Goto | Asks::GoOn => None,
    };
    let beginnings: Vec<String> = every().filter_map(beginning).collect();
    assert!(beginnings.len() >= 3);
    for (beginning, word) in beginnings.iter().flat_map(|beginning| ["h", "stop"].map(|word| (beginning, word))) {
        assert!(is_stop(format!("{beginning}{word}").as_bytes()), "{beginning}{word}");
        assert!(!is_stop(format!("{beginning}w").as_bytes()), "{beginning}w");
    }
}

fn markdown() -> String {
    let mut text = "| MSGID | CONTENT | asks for |\n|---|---|---|\n".to_owned();
    for Known { id, asks } in every() {
        let (content, what) = match asks {
            Asks::Halt(command) => ("anything".to_owned(), command.to_string()),
            Asks::For(command) => (format!("`{id}`"), command.to_string()),
            Asks::Goto => (format!("`{id}(X,Y)`"), "driving to the cell (X, Y), if old clients may drive".to_owned()),
            Asks::Move => {
                let what = "a move: `w` `s` `a` `l` `d` `r` `z` `x`, if old clients may drive; `h` and `stop` are STOP, always";
                (format!("`{id}(w)`"), what.to_owned())
            }
            Asks::GoOn => (format!("`{id}`"), "taking the photo again where it has failed, else START".to_owned()),
            Asks::Change => {
                let what = "the same moves, `h` and `stop` being STOP; with `luggage`, `safe` or `danger`";
                (format!("`{id}(robot,w)`, `{id}(luggage,safe)`"), what.to_owned())
            }
        };
        text.push_str(&format!("| `{id}` | {content} | {what} |\n"));
    }
    text
}

#[test]
fn the_documentation_shows_the_table_as_it_is() {
    crate::api::tests::documented::shows("mqtt.md", "the table of old messages", &markdown());
}
