//! Messages in CDR, read where they lie: a field is found by skipping those before it.
//!
//! Plain CDR of both byte orders, versions 1 and 2 (OMG, DDS-XTYPES 1.3, 7.4). Values are aligned to their size, counted from
//! the end of the four bytes that name the encoding; in version 2 to four bytes at most.

use std::{borrow::Cow, str};

use super::{
    cdr_types::{CdrType, CdrTypes, Number},
    limits::MAX_DEPTH,
};

/// Bytes before the message that name the encoding.
const HEADER_BYTES: usize = 4;

/// Place in a message.
#[derive(Debug, Clone, Copy)]
struct Place<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big_endian: bool,
    most_alignment: usize,
}

/// Value in a message.
#[derive(Debug, Clone, Copy)]
pub struct CdrView<'a> {
    types: &'a CdrTypes,
    kind: ViewKind<'a>,
    place: Place<'a>,
}

#[derive(Debug, Clone, Copy)]
enum ViewKind<'a> {
    Root,
    Of(&'a CdrType),
}

impl<'a> CdrView<'a> {
    /// Opens a message; `None` if its encoding is not plain CDR.
    pub fn open(types: &'a CdrTypes, message: &'a [u8]) -> Option<Self> {
        let (header, bytes) = message.split_at_checked(HEADER_BYTES)?;
        let (is_big_endian, most_alignment) = match header[..2] {
            [0, 0] => (true, 8),
            [0, 1] => (false, 8),
            [0, 6] => (true, 4),
            [0, 7] => (false, 4),
            _ => return None,
        };
        let place = Place { bytes, at: 0, is_big_endian, most_alignment };
        Some(Self { types, kind: ViewKind::Root, place })
    }

    /// Returns a field's value.
    pub fn field(&self, name: &str) -> Option<Self> {
        let fields = match self.kind {
            ViewKind::Root => self.types.fields(self.types.root),
            ViewKind::Of(CdrType::Struct(id)) => self.types.fields(*id),
            ViewKind::Of(CdrType::Optional(inner)) => return self.present(inner)?.field(name),
            ViewKind::Of(_) => return None,
        };
        let mut place = self.place;
        for field in fields {
            if field.name == name {
                return Some(Self { types: self.types, kind: ViewKind::Of(&field.kind), place });
            }
            place.skip(self.types, &field.kind, 0)?;
        }
        None
    }

    /// Returns the value of an optional one, if it is there.
    fn present(&self, inner: &'a CdrType) -> Option<Self> {
        let mut place = self.place;
        (place.count()? == 1).then_some(Self { types: self.types, kind: ViewKind::Of(inner), place })
    }

    /// Returns a number.
    pub fn number(&self) -> Option<f64> {
        let ViewKind::Of(CdrType::Number(kind)) = self.kind else { return None };
        self.place.clone().number(*kind)
    }

    /// Returns a whole number.
    pub fn integer(&self) -> Option<i64> {
        let ViewKind::Of(CdrType::Number(kind)) = self.kind else { return None };
        self.place.clone().integer(*kind)
    }

    /// Returns a text.
    pub fn text(&self) -> Option<Cow<'a, str>> {
        let ViewKind::Of(CdrType::Text) = self.kind else { return None };
        let bytes = self.place.clone().text()?;
        str::from_utf8(bytes).ok().map(Cow::Borrowed)
    }

    /// Returns a sequence or array of bytes.
    pub fn bytes(&self) -> Option<Cow<'a, [u8]>> {
        let (inner, count, mut place) = self.elements()?;
        let CdrType::Number(Number::Unsigned(1) | Number::Signed(1)) = inner else { return None };
        place.take(count).map(Cow::Borrowed)
    }

    /// Hands over the values of a sequence or array one after the other; `None` if the message ends before the last.
    pub fn each(&self, visit: &mut dyn FnMut(Self)) -> Option<()> {
        let (inner, count, mut place) = self.elements()?;
        for _ in 0..count {
            let before = place.at;
            visit(Self { types: self.types, kind: ViewKind::Of(inner), place });
            place.skip(self.types, inner, 0)?;
            if place.at == before {
                return None;
            }
        }
        Some(())
    }

    /// Returns the type, number and place of the values of a sequence or array.
    fn elements(&self) -> Option<(&'a CdrType, usize, Place<'a>)> {
        let mut place = self.place;
        match self.kind {
            ViewKind::Of(CdrType::Array(inner, count)) => Some((inner, *count, place)),
            ViewKind::Of(CdrType::Sequence(inner)) => {
                let count = place.count()?;
                Some((inner, count, place))
            }
            _ => None,
        }
    }
}

impl<'a> Place<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size.min(self.most_alignment).max(1));
    }

    /// Reads the bytes of a number, the least significant one first.
    fn number_bytes(&mut self, size: usize) -> Option<[u8; 8]> {
        self.align(size);
        let mut bytes = [0; 8];
        let target = bytes.get_mut(..size)?;
        target.copy_from_slice(self.take(size)?);
        if self.is_big_endian {
            target.reverse();
        }
        Some(bytes)
    }

    fn count(&mut self) -> Option<usize> {
        self.number_bytes(4).map(|bytes| u64::from_le_bytes(bytes) as usize)
    }

    fn integer(&mut self, kind: Number) -> Option<i64> {
        let value = u64::from_le_bytes(self.number_bytes(kind.size())?);
        match kind {
            Number::Bool | Number::Unsigned(_) => i64::try_from(value).ok(),
            Number::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                Some((value << unused) as i64 >> unused)
            }
            Number::Float(_) => None,
        }
    }

    fn number(&mut self, kind: Number) -> Option<f64> {
        let Number::Float(size) = kind else { return self.integer(kind).map(|value| value as f64) };
        let bits = u64::from_le_bytes(self.number_bytes(size)?);
        Some(if size == 4 { f64::from(f32::from_bits(bits as u32)) } else { f64::from_bits(bits) })
    }

    /// Reads a text without the zero at its end.
    fn text(&mut self) -> Option<&'a [u8]> {
        let count = self.count()?;
        let bytes = self.take(count)?;
        Some(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    /// Skips a value. Every step takes at least one byte of the message, so that no count in it can make this long.
    fn skip(&mut self, types: &CdrTypes, kind: &CdrType, depth: usize) -> Option<()> {
        if depth > MAX_DEPTH {
            return None;
        }
        match kind {
            CdrType::Number(number) => self.number_bytes(number.size()).map(drop),
            CdrType::Text => self.text().map(drop),
            CdrType::Struct(id) => match types.fields(*id) {
                // A structure without fields is one byte in ROS 2.
                [] => self.take(1).map(drop),
                fields => fields.iter().try_for_each(|field| self.skip(types, &field.kind, depth + 1)),
            },
            CdrType::Array(inner, count) => self.skip_several(types, inner, *count, depth),
            CdrType::Sequence(inner) => {
                let count = self.count()?;
                self.skip_several(types, inner, count, depth)
            }
            CdrType::Optional(inner) => match self.count()? {
                0 => Some(()),
                1 => self.skip(types, inner, depth + 1),
                _ => None,
            },
            CdrType::Opaque => None,
        }
    }

    fn skip_several(&mut self, types: &CdrTypes, inner: &CdrType, count: usize, depth: usize) -> Option<()> {
        if count == 0 {
            return Some(());
        }
        if let CdrType::Number(number) = inner {
            self.align(number.size());
            return self.take(count.checked_mul(number.size())?).map(drop);
        }
        for _ in 0..count {
            let before = self.at;
            self.skip(types, inner, depth + 1)?;
            if self.at == before {
                return None;
            }
        }
        Some(())
    }
}
