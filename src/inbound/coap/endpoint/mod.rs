//! A CoAP server endpoint that knows no resource, socket or clock: datagrams in, requests out to an application, its answers back
//! in, datagrams out (RFC 7252, 7641, 7959, 7967, 9175). What is at which path is the application's business.

pub mod code;
pub mod format;
pub mod request;
pub mod response;
