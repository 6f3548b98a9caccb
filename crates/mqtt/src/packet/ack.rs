//! Packets that are nothing but the id of another: PUBACK, PUBREC, PUBREL, PUBCOMP, UNSUBACK.

use super::Fields;
use crate::frame::Malformed;

/// The id that is acknowledged.
///
/// # Errors
/// When the body is anything but an id.
pub fn read(body: &[u8]) -> Result<u16, Malformed> {
    let mut fields = Fields::new(body);
    let id = fields.id()?;
    fields.end().map(|()| id)
}

/// The id and the codes of a SUBACK.
#[cfg(test)]
pub(crate) fn read_suback(body: &[u8]) -> Result<(u16, &[u8]), Malformed> {
    let mut fields = Fields::new(body);
    Ok((fields.id()?, fields.rest()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_acknowledgement_is_an_id_and_nothing_else() {
        assert_eq!(read(&[1, 2]), Ok(0x0102));
        assert_eq!(read(&[0, 0]), Err(Malformed::Id));
        assert_eq!(read(&[1]), Err(Malformed::Short("packet id")));
        assert_eq!(read(&[0, 1, 0]), Err(Malformed::Trailing(1)));
        assert_eq!(read_suback(&[0, 9, 1, 0x80]), Ok((9, &[1, 0x80][..])));
    }
}
