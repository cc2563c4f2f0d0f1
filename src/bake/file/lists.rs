//! Lists of little-endian numbers, each behind its length: what a bake file is
//! made of.

use super::{FileError, array};
use crate::bake::rows::{Columns, Indices};

/// A number that a list can hold.
pub(super) trait Number: Copy {
    const SIZE: usize;
    fn write(self, out: &mut Vec<u8>);
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! number {
    ($($type:ty),*) => {$(
        impl Number for $type {
            const SIZE: usize = size_of::<$type>();
            fn write(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn read(bytes: &[u8]) -> Self {
                Self::from_le_bytes(array(bytes))
            }
        }
    )*};
}

number!(u8, i8, u16, u32, f32, f64);

/// Writes lists, one after the other.
#[derive(Default)]
pub(super) struct Writer {
    pub(super) bytes: Vec<u8>,
}

impl Writer {
    pub(super) fn list<T: Number>(&mut self, items: &[T]) {
        self.bytes
            .extend_from_slice(&(items.len() as u64).to_le_bytes());
        self.bytes.reserve(items.len() * T::SIZE);
        items.iter().for_each(|item| item.write(&mut self.bytes));
    }

    /// Runs, then listed functions; one of the two is empty.
    pub(super) fn columns(&mut self, columns: &Columns) {
        match columns {
            Columns::Listed(list) => {
                self.list::<u32>(&[]);
                self.indices(list);
            }
            Columns::Runs(first) => {
                self.list(first);
                self.indices(&Indices::Narrow(Vec::new()));
            }
        }
    }

    /// Both widths in turn; one of the lists is empty.
    pub(super) fn indices(&mut self, indices: &Indices) {
        match indices {
            Indices::Narrow(list) => {
                self.list(list);
                self.list::<u32>(&[]);
            }
            Indices::Wide(list) => {
                self.list::<u16>(&[]);
                self.list(list);
            }
        }
    }
}

/// Reads lists, one after the other.
pub(super) struct Reader<'a> {
    /// What was not read yet.
    pub(super) rest: &'a [u8],
}

impl Reader<'_> {
    pub(super) fn list<T: Number>(&mut self) -> Result<Vec<T>, FileError> {
        let (length, rest) = self.rest.split_at_checked(8).ok_or(FileError::Damaged)?;
        let length =
            usize::try_from(u64::from_le_bytes(array(length))).map_err(|_| FileError::Damaged)?;
        let size = length.checked_mul(T::SIZE).ok_or(FileError::Damaged)?;
        let (items, rest) = rest.split_at_checked(size).ok_or(FileError::Damaged)?;
        self.rest = rest;
        Ok(items.chunks_exact(T::SIZE).map(T::read).collect())
    }

    pub(super) fn groups<T: Number, const N: usize>(&mut self) -> Result<Vec<[T; N]>, FileError> {
        let flat = self.list::<T>()?;
        let (groups, rest) = flat.as_chunks::<N>();
        if rest.is_empty() {
            Ok(groups.to_vec())
        } else {
            Err(FileError::Damaged)
        }
    }

    pub(super) fn columns(&mut self) -> Result<Columns, FileError> {
        let (runs, listed) = (self.list::<u32>()?, self.indices()?);
        Ok(if runs.is_empty() {
            Columns::Listed(listed)
        } else {
            Columns::Runs(runs)
        })
    }

    pub(super) fn indices(&mut self) -> Result<Indices, FileError> {
        let (narrow, wide) = (self.list::<u16>()?, self.list::<u32>()?);
        Ok(if wide.is_empty() {
            Indices::Narrow(narrow)
        } else {
            Indices::Wide(wide)
        })
    }
}
