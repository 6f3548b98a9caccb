//! Finds the end of a chunked body (RFC 9112, section 7.1). It is as strict as hyper: a body that hyper refuses is an
//! error here too. The caller gets the contents of the chunks.

/// State of reading a chunked body.
#[derive(Debug, Default)]
pub(super) struct Chunks {
    at: BodyState,
    size: u64,
}

#[derive(Clone, Copy, Debug, Default)]
enum BodyState {
    #[default]
    Start,
    Size,
    /// After the size. Here only white space, an extension or the end of the line may follow.
    Space,
    Extension,
    SizeLf,
    Data,
    DataCr,
    DataLf,
    /// The line after the last chunk. It is empty or a trailer.
    EndCr,
    EndLf,
    Trailer,
    TrailerLf,
}

impl Chunks {
    /// Reads up to the end of the body, and calls `shown` with the contents of the chunks. Returns the number of
    /// bytes read. At the end, also returns whether the body is valid.
    pub(super) fn take(&mut self, bytes: &[u8], mut shown: impl FnMut(&[u8])) -> (usize, Option<Result<(), ()>>) {
        let mut taken = 0;
        while let Some(&byte) = bytes.get(taken) {
            if matches!(self.at, BodyState::Data) {
                let here = usize::try_from(self.size).unwrap_or(usize::MAX).min(bytes.len() - taken);
                shown(&bytes[taken..taken + here]);
                taken += here;
                self.size -= here as u64;
                if self.size == 0 {
                    self.at = BodyState::DataCr;
                }
                continue;
            }
            taken += 1;
            match self.next(byte) {
                Some(BodyState::Start) if matches!(self.at, BodyState::EndLf) => return (taken, Some(Ok(()))),
                Some(next) => self.at = next,
                None => return (taken, Some(Err(()))),
            }
        }
        (taken, None)
    }

    fn next(&mut self, byte: u8) -> Option<BodyState> {
        Some(match (self.at, byte) {
            (BodyState::Start, _) => {
                self.size = 0;
                self.digit(byte)?
            }
            (BodyState::Size | BodyState::Space, b'\t' | b' ') => BodyState::Space,
            (BodyState::Size | BodyState::Space, b';') => BodyState::Extension,
            (BodyState::Size | BodyState::Space | BodyState::Extension, b'\r') => BodyState::SizeLf,
            (BodyState::Size, _) => self.digit(byte)?,
            (BodyState::SizeLf, b'\n') if self.size == 0 => BodyState::EndCr,
            (BodyState::SizeLf, b'\n') => BodyState::Data,
            (BodyState::DataCr, b'\r') => BodyState::DataLf,
            (BodyState::DataLf | BodyState::EndLf, b'\n') => BodyState::Start,
            (BodyState::Trailer, b'\r') => BodyState::TrailerLf,
            (BodyState::TrailerLf, b'\n') => BodyState::EndCr,
            (BodyState::EndCr, b'\r') => BodyState::EndLf,
            (BodyState::EndCr | BodyState::Trailer, _) => BodyState::Trailer,
            (BodyState::Extension, _) if byte != b'\n' => BodyState::Extension,
            (
                BodyState::Space
                | BodyState::Extension
                | BodyState::SizeLf
                | BodyState::DataCr
                | BodyState::DataLf
                | BodyState::EndLf
                | BodyState::TrailerLf
                | BodyState::Data,
                _,
            ) => {
                return None;
            }
        })
    }

    fn digit(&mut self, byte: u8) -> Option<BodyState> {
        let digit = char::from(byte).to_digit(16)?;
        self.size = self.size.checked_mul(16)?.checked_add(u64::from(digit))?;
        Some(BodyState::Size)
    }
}
