//! The links of the test application at `/.well-known/core`, as the plug-test descriptions of the LINK cases ask for
//! them. The filter is the endpoint's own code, which the LINK cases test.

use coap_endpoint::Link;

pub(crate) fn links() -> Vec<Link> {
    let mut links: Vec<Link> = ["/test", "/query", "/separate", "/create1"].map(Link::new).into();
    links.extend([
        Link::new("/large").with("sz", "1280"),
        Link::new("/large-update").with("sz", "1280"),
        Link::new("/obs").flag("obs"),
        Link::new("/link1").with("rt", "Type1 Type2").with("if", "If1"),
        Link::new("/link2").with("rt", "Type2 Type3").with("if", "If2"),
        Link::new("/link3").with("rt", "Type1 Type3").with("if", "foo"),
        Link::new("/path").with("ct", "40"),
    ]);
    links
}

pub(crate) fn below_path() -> Vec<Link> {
    ["/path/sub1", "/path/sub2", "/path/sub3"].map(Link::new).into()
}
