//! Where a chunked body ends (RFC 9112, section 7.1), as strictly as hyper reads it: what hyper would not take is an error here
//! too. What the chunks hold is shown to whoever wants it.

/// A chunked body that is passing by.
#[derive(Debug, Default)]
pub(super) struct Chunks {
    at: At,
    size: u64,
}

#[derive(Clone, Copy, Debug, Default)]
enum At {
    #[default]
    Start,
    Size,
    /// Behind the size only white space, an extension or the end of the line may follow.
    Space,
    Extension,
    SizeLf,
    Data,
    DataCr,
    DataLf,
    /// The line after the last chunk: empty, or a trailer.
    EndCr,
    EndLf,
    Trailer,
    TrailerLf,
}

impl Chunks {
    /// Takes bytes up to the end of the body, shows what the chunks hold, and says how many it took, and whether it has ended well.
    pub(super) fn take(&mut self, bytes: &[u8], mut shown: impl FnMut(&[u8])) -> (usize, Option<Result<(), ()>>) {
        let mut taken = 0;
        while let Some(&byte) = bytes.get(taken) {
            if matches!(self.at, At::Data) {
                let here = usize::try_from(self.size).unwrap_or(usize::MAX).min(bytes.len() - taken);
                shown(&bytes[taken..taken + here]);
                taken += here;
                self.size -= here as u64;
                if self.size == 0 {
                    self.at = At::DataCr;
                }
                continue;
            }
            taken += 1;
            match self.next(byte) {
                Some(At::Start) if matches!(self.at, At::EndLf) => return (taken, Some(Ok(()))),
                Some(next) => self.at = next,
                None => return (taken, Some(Err(()))),
            }
        }
        (taken, None)
    }

    fn next(&mut self, byte: u8) -> Option<At> {
        Some(match (self.at, byte) {
            (At::Start, _) => {
                self.size = 0;
                self.digit(byte)?
            }
            (At::Size | At::Space, b'\t' | b' ') => At::Space,
            (At::Size | At::Space, b';') => At::Extension,
            (At::Size | At::Space | At::Extension, b'\r') => At::SizeLf,
            (At::Size, _) => self.digit(byte)?,
            (At::SizeLf, b'\n') if self.size == 0 => At::EndCr,
            (At::SizeLf, b'\n') => At::Data,
            (At::DataCr, b'\r') => At::DataLf,
            (At::DataLf | At::EndLf, b'\n') => At::Start,
            (At::Trailer, b'\r') => At::TrailerLf,
            (At::TrailerLf, b'\n') => At::EndCr,
            (At::EndCr, b'\r') => At::EndLf,
            (At::EndCr | At::Trailer, _) => At::Trailer,
            (At::Extension, _) if byte != b'\n' => At::Extension,
            (At::Space | At::Extension | At::SizeLf | At::DataCr | At::DataLf | At::EndLf | At::TrailerLf | At::Data, _) => {
                return None;
            }
        })
    }

    fn digit(&mut self, byte: u8) -> Option<At> {
        let digit = char::from(byte).to_digit(16)?;
        self.size = self.size.checked_mul(16)?.checked_add(u64::from(digit))?;
        Some(At::Size)
    }
}
