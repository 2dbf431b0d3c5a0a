//! ZIP archives of uncompressed files, written from front to back; the same files give the same bytes.
//!
//! Every file is stored with its length and its CRC-32 before it, at the time 1980-01-01 00:00. Numbers beyond 32 bits
//! are written as ZIP64 (APPNOTE.TXT 6.3.10, 4.3 and 4.5.3).

/// The value of a 32-bit field whose number is in a ZIP64 field.
const IN_ZIP64: u32 = u32::MAX;
/// 1980-01-01, the earliest date of the format.
const FIRST_DAY: u16 = 1 << 5 | 1;
/// The flag of names in UTF-8.
const UTF8_FLAG: u16 = 1 << 11;
/// The version needed to extract, in tenths: without ZIP64, and with it as [`ZIP64_VERSION`].
const ZIP_VERSION: u16 = 20;
const ZIP64_VERSION: u16 = 45;

/// An archive of files whose names and lengths are known.
#[derive(Debug)]
pub(super) struct Zip {
    files: Vec<ZipEntry>,
    /// The offset of the central directory.
    end: u64,
}

#[derive(Debug)]
struct ZipEntry {
    name: String,
    length: u64,
    offset: u64,
}

impl ZipEntry {
    /// Returns the ZIP64 field with those of these numbers that need it.
    fn extra(numbers: &[u64]) -> Vec<u8> {
        let large: Vec<u8> = numbers.iter().filter(|n| is_large(**n)).flat_map(|n| n.to_le_bytes()).collect();
        if large.is_empty() { large } else { [&[1, 0], &short(large.len()).to_le_bytes()[..], &large].concat() }
    }

    /// Returns the local file header.
    fn head(&self, crc: u32) -> Vec<u8> {
        let extra = Self::extra(&[self.length, self.length]);
        let mut out = b"PK\x03\x04".to_vec();
        out.extend(self.facts(crc, &extra));
        out.extend(self.name.as_bytes());
        out.extend(extra);
        out
    }

    /// Returns the fields that the local header and the central directory share.
    fn facts(&self, crc: u32, extra: &[u8]) -> Vec<u8> {
        let version = if extra.is_empty() { ZIP_VERSION } else { ZIP64_VERSION };
        let (stored, midnight, name) = (0_u16, 0_u16, short(self.name.len()));
        let mut out = Vec::with_capacity(26);
        for number in [version, UTF8_FLAG, stored, midnight, FIRST_DAY] {
            out.extend(number.to_le_bytes());
        }
        for number in [crc, narrow(self.length), narrow(self.length)] {
            out.extend(number.to_le_bytes());
        }
        for number in [name, short(extra.len())] {
            out.extend(number.to_le_bytes());
        }
        out
    }

    /// Returns the entry in the central directory.
    fn entry(&self, crc: u32) -> Vec<u8> {
        let extra = Self::extra(&[self.length, self.length, self.offset]);
        let mut out = b"PK\x01\x02".to_vec();
        out.extend(ZIP64_VERSION.to_le_bytes());
        out.extend(self.facts(crc, &extra));
        // comment length, disk number, internal and external attributes
        out.extend([0; 10]);
        out.extend(narrow(self.offset).to_le_bytes());
        out.extend(self.name.as_bytes());
        out.extend(extra);
        out
    }
}

impl Zip {
    /// Creates the archive of files with these names, which are short, and lengths.
    pub(super) fn new(files: impl IntoIterator<Item = (String, u64)>) -> Self {
        let (mut all, mut offset) = (Vec::new(), 0);
        for (name, length) in files {
            let file = ZipEntry { name, length, offset };
            offset += file.head(0).len() as u64 + length;
            all.push(file);
        }
        Self { files: all, end: offset }
    }

    /// Returns the length of the archive in bytes.
    pub(super) fn length(&self) -> u64 {
        self.end + self.list(&vec![0; self.files.len()]).len() as u64
    }

    /// Returns the local header of a file with this checksum.
    pub(super) fn head(&self, file: usize, crc: u32) -> Vec<u8> {
        self.files.get(file).map(|file| file.head(crc)).unwrap_or_default()
    }

    /// Returns the central directory and its end records, given the checksums of all files.
    pub(super) fn list(&self, crcs: &[u32]) -> Vec<u8> {
        let mut out: Vec<u8> = self.files.iter().zip(crcs).flat_map(|(file, crc)| file.entry(*crc)).collect();
        let (n, length) = (self.files.len() as u64, out.len() as u64);
        if is_large(self.end) || is_large(length) || n >= u64::from(u16::MAX) {
            let at = self.end + length;
            out.extend(b"PK\x06\x06");
            out.extend(44_u64.to_le_bytes());
            out.extend([ZIP64_VERSION.to_le_bytes(), ZIP64_VERSION.to_le_bytes()].concat());
            out.extend([0; 8]);
            for number in [n, n, length, self.end] {
                out.extend(number.to_le_bytes());
            }
            out.extend(b"PK\x06\x07");
            out.extend(0_u32.to_le_bytes());
            out.extend(at.to_le_bytes());
            out.extend(1_u32.to_le_bytes());
        }
        out.extend(b"PK\x05\x06");
        out.extend([0; 4]);
        let n = short(self.files.len());
        out.extend([n.to_le_bytes(), n.to_le_bytes()].concat());
        out.extend(narrow(length).to_le_bytes());
        out.extend(narrow(self.end).to_le_bytes());
        out.extend([0; 2]);
        out
    }
}

fn is_large(number: u64) -> bool {
    number >= u64::from(IN_ZIP64)
}

/// Returns a number in 32 bits, or [`IN_ZIP64`] if it is too large.
fn narrow(number: u64) -> u32 {
    u32::try_from(number).unwrap_or(IN_ZIP64)
}

/// Returns a number in 16 bits, or the maximum if it is too large.
fn short(number: usize) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_four_gibibytes_is_written_as_zip64() {
        let zip = Zip::new([("a".to_owned(), 5 << 30), ("b".to_owned(), 3)]);
        let (head, list) = (zip.head(0, 7), zip.list(&[7, 8]));
        assert_eq!(head.len(), 30 + 1 + 20, "the length stands in a field of its own, twice");
        assert_eq!(head[18..26], [0xff; 8]);
        assert_eq!(
            head[31..],
            [&[1, 0, 16, 0], &(5_u64 << 30).to_le_bytes()[..], &(5_u64 << 30).to_le_bytes()].concat()
        );
        // the second file is small, but its offset is large
        let second = 46 + 1 + 20;
        assert_eq!(list[second + 20..second + 28], [3, 0, 0, 0, 3, 0, 0, 0]);
        assert_eq!(list[second + 42..second + 46], [0xff; 4]);
        let offset = head.len() as u64 + (5 << 30);
        assert_eq!(list[second + 47..second + 59], [&[1, 0, 8, 0], &offset.to_le_bytes()[..]].concat());
        assert_eq!(list[second + 59..second + 63], *b"PK\x06\x06");
        assert_eq!(zip.length(), offset + zip.head(1, 8).len() as u64 + 3 + list.len() as u64);
    }
}
