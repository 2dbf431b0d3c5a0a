//! ZIP archives of compressed files, written from front to back, the same bytes for the same files.
//!
//! Lengths and checksums follow the bytes of each file, so that nothing is held: every file is deflated, at the time
//! 1980-01-01 00:00. Source: APPNOTE.TXT 6.3.10, sections 4.3.7 to 4.3.16.

use std::io::{self, Write};

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};

/// 1980-01-01, the first day that there is.
const DAY: u16 = 1 << 5 | 1;
/// Lengths and checksum follow the bytes; names are in UTF-8.
const FLAGS: u16 = 1 << 3 | 1 << 11;
/// The version that is needed to read it, as tenths.
const VERSION: u16 = 20;
const DEFLATED: u16 = 8;
/// How hard the bytes are compressed: the usual balance of zlib. At 1 models are a third longer, at 9 they take twice
/// as long and are hardly shorter.
const LEVEL: u32 = 6;

/// Most bytes that an archive of so many files with names of so many bytes takes beside the bytes of its files, where
/// these are at most as long as they are stored.
pub(super) const fn overhead(n_files: u128, names: u128) -> u128 {
    n_files * (30 + 16 + 46) + 2 * names + 22
}

/// An archive that is being written.
pub(super) struct Package<'a> {
    out: Counted<'a>,
    list: Vec<u8>,
    n_files: u16,
}

/// Bytes on their way, counted.
struct Counted<'a> {
    out: &'a mut dyn Write,
    n: u64,
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.out.write(bytes)?;
        self.n += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The bytes of one file on their way into an archive.
struct Entry<'a, 'b> {
    packed: DeflateEncoder<&'b mut Counted<'a>>,
    crc: Crc,
    n: u64,
}

impl Write for Entry<'_, '_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.packed.write(bytes)?;
        self.crc.update(&bytes[..n]);
        self.n += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.packed.flush()
    }
}

impl<'a> Package<'a> {
    /// An archive without files as yet.
    pub(super) fn new(out: &'a mut dyn Write) -> Self {
        Self { out: Counted { out, n: 0 }, list: Vec::new(), n_files: 0 }
    }

    /// Appends a file, whose bytes `write` writes.
    ///
    /// # Errors
    /// Those of `write`, and a file or an archive of 4 GiB or more.
    pub(super) fn file<E: From<io::Error>>(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
    ) -> Result<(), E> {
        let offset = narrow(self.out.n)?;
        let name_length = u16::try_from(name.len()).map_err(|_| too_long())?;
        let head = [VERSION, FLAGS, DEFLATED, 0, DAY].map(u16::to_le_bytes);
        self.out.write_all(b"PK\x03\x04")?;
        self.out.write_all(head.as_flattened())?;
        self.out.write_all(&[0; 12])?;
        self.out.write_all([name_length, 0].map(u16::to_le_bytes).as_flattened())?;
        self.out.write_all(name.as_bytes())?;
        let start = self.out.n;
        let (crc, n) = {
            let packed = DeflateEncoder::new(&mut self.out, Compression::new(LEVEL));
            let mut entry = Entry { packed, crc: Crc::new(), n: 0 };
            write(&mut entry)?;
            entry.packed.try_finish()?;
            (entry.crc.sum(), entry.n)
        };
        let numbers = [crc, narrow(self.out.n - start)?, narrow(n)?].map(u32::to_le_bytes);
        self.out.write_all(b"PK\x07\x08")?;
        self.out.write_all(numbers.as_flattened())?;
        self.list.extend_from_slice(b"PK\x01\x02");
        self.list.extend_from_slice(&VERSION.to_le_bytes());
        self.list.extend_from_slice(head.as_flattened());
        self.list.extend_from_slice(numbers.as_flattened());
        self.list.extend_from_slice(&name_length.to_le_bytes());
        // no extra field, no comment, on the first disk, of no kind, without attributes
        self.list.extend_from_slice(&[0; 12]);
        self.list.extend_from_slice(&offset.to_le_bytes());
        self.list.extend_from_slice(name.as_bytes());
        self.n_files += 1;
        Ok(())
    }

    /// Writes the list of files.
    ///
    /// # Errors
    /// The writer fails, or the archive has 4 GiB or more.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let (start, length) = (narrow(self.out.n)?, narrow(self.list.len() as u64)?);
        self.out.write_all(&self.list)?;
        self.out.write_all(b"PK\x05\x06")?;
        self.out.write_all([0, 0, self.n_files, self.n_files].map(u16::to_le_bytes).as_flattened())?;
        self.out.write_all([length, start].map(u32::to_le_bytes).as_flattened())?;
        self.out.write_all(&[0; 2])
    }
}

fn narrow(n: u64) -> io::Result<u32> {
    u32::try_from(n).map_err(|_| too_long())
}

fn too_long() -> io::Error {
    io::Error::other("the archive takes 4 GiB or more")
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn the_list_leads_to_every_file_and_its_bytes() {
        let contents = [("a", b"some bytes".repeat(5)), ("folder/b", Vec::new())];
        let mut bytes = Vec::new();
        let mut package = Package::new(&mut bytes);
        for (name, content) in &contents {
            package.file(name, |out| out.write_all(content)).expect("it fits");
        }
        package.finish().expect("it fits");
        let names = contents.iter().map(|(name, _)| name.len() as u128).sum();
        let stored: usize = contents.iter().map(|(_, content)| content.len() + 16).sum();
        assert!(bytes.len() as u128 <= overhead(2, names) + stored as u128);
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        let end = bytes.len() - 22;
        assert_eq!(&bytes[end..end + 4], b"PK\x05\x06");
        let mut at = number(end + 16);
        assert_eq!(at + number(end + 12), end);
        for (name, content) in &contents {
            assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
            let (crc, packed, n, offset) = (number(at + 16), number(at + 20), number(at + 24), number(at + 42));
            assert_eq!(&bytes[at + 46..at + 46 + name.len()], name.as_bytes());
            at += 46 + name.len();
            let start = offset + 30 + name.len();
            let mut found = Vec::new();
            let mut decoder = flate2::read::DeflateDecoder::new(&bytes[start..start + packed]);
            decoder.read_to_end(&mut found).expect("it is deflated");
            let mut sum = Crc::new();
            sum.update(content);
            assert_eq!((&found, n, crc), (content, content.len(), sum.sum() as usize));
            let after = [0x0807_4b50, crc, packed, n];
            assert_eq!([0, 4, 8, 12].map(|k| number(start + packed + k)), after);
        }
    }
}
