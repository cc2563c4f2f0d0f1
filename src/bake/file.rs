//! The bake file: one bake, checked when read.
//!
//! magic, format version, key, length and checksum of the payload, payload.
//! The payload is a sequence of lists of little-endian numbers, each behind its
//! length; the first names the scheme, which decides what lists the transfer
//! has. What not every bake has comes last: the sky, then folded bounces, which
//! begin with a name. A later version appends lists and raises the version.

mod lists;

use thiserror::Error;

use super::audit::{ErrorParts, LightErrors};
use super::basis::Basis;
use super::key::BakeKey;
use super::low_rank::{Folded, LowRank};
use super::paper::PaperRows;
use super::rows::Rows;
use super::scheme::{Operator, Partitioner, Scheme};
use super::sky::Sky;
use super::slices::Slices;
use super::{Bake, BakeStats};
use crate::maths::spherical_harmonics::HARMONICS;
use lists::{Reader, Writer};

const MAGIC: &[u8; 8] = b"relume\x1ab";
const FORMAT_VERSION: u32 = 7;
/// Named behind the scheme where a bake has slices: one without has no byte for
/// them.
const SLICES_PART: u8 = 1;
/// What folded bounces begin with: as the length of a list it would be beyond
/// any memory, so it is not the sky's.
const FOLDED: &[u8; 8] = b"folded\x1a\xff";
/// Bytes before the payload: magic, version, key, length, checksum.
const HEADER: usize = 8 + 4 + 32 + 8 + 32;

/// Why a file is not the bake that was looked for.
#[derive(Debug, Error, PartialEq, Eq)]
pub(super) enum FileError {
    #[error("it is not a bake file")]
    Foreign,
    #[error("it has format version {0}, this program writes {FORMAT_VERSION}")]
    OtherVersion(u32),
    #[error("it belongs to another scene or other settings")]
    OtherKey,
    #[error("it is cut short or damaged")]
    Damaged,
    #[error("its contents do not fit together: {0}")]
    Inconsistent(&'static str),
}

/// The bytes of a bake's file.
pub(super) fn encode(bake: &Bake, key: &BakeKey) -> Vec<u8> {
    let payload = encode_payload(bake);
    let mut bytes = Vec::with_capacity(HEADER + payload.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&FORMAT_VERSION.to_le_bytes());
    bytes.extend_from_slice(key.bytes());
    bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    bytes.extend_from_slice(blake3::hash(&payload).as_bytes());
    bytes.extend_from_slice(&payload);
    bytes
}

/// The bake in a file's bytes, if it is whole and the one with the key.
pub(super) fn decode(bytes: &[u8], key: &BakeKey) -> Result<Bake, FileError> {
    if bytes.get(..8) != Some(MAGIC.as_slice()) {
        return Err(FileError::Foreign);
    }
    let header = bytes.get(..HEADER).ok_or(FileError::Damaged)?;
    let version = u32::from_le_bytes(array(&header[8..12]));
    if version != FORMAT_VERSION {
        return Err(FileError::OtherVersion(version));
    }
    if BakeKey::from_bytes(array(&header[12..44])) != *key {
        return Err(FileError::OtherKey);
    }
    let payload = &bytes[HEADER..];
    let length = u64::from_le_bytes(array(&header[44..52]));
    if length != payload.len() as u64 || blake3::hash(payload).as_bytes() != &header[52..84] {
        return Err(FileError::Damaged);
    }
    decode_payload(payload)
}

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.try_into().expect("the slice has the array's length")
}

fn encode_payload(bake: &Bake) -> Vec<u8> {
    let mut out = Writer::default();
    let stats = &bake.stats;
    let mut head = vec![stats.scheme.tag(), stats.partitioner.tag()];
    head.extend(bake.slices.as_ref().map(|_| SLICES_PART));
    out.list(&head);
    out.list(&[stats.rays]);
    out.list(&[stats.threshold]);
    out.list(&[
        stats.arrived_share,
        stats.escaped_share,
        stats.senders_per_group,
        stats.largest_eigenvalue,
        stats.energy_mean,
        stats.energy_worst,
    ]);
    out.list(&stats.errors.numbers());
    out.list(stats.error_asked.as_slice());
    out.list(&bake.backs.iter().map(|&b| u8::from(b)).collect::<Vec<_>>());

    out.list(&bake.open_points);
    let basis = bake.basis.lists();
    out.list(basis.vertex_of_slot);
    out.list(&basis.slot_counts);
    out.list(&basis.function_counts);
    out.list(basis.values);
    out.list(basis.masses);

    match &bake.operator {
        Operator::LowRank(operator) => out.low_rank(operator),
        Operator::Paper(rows) => out.paper_rows(rows),
    }
    if let Some(slices) = &bake.slices {
        out.slices(slices);
    }
    // A closed scene has no byte for the sky.
    if let Some(sky) = &bake.sky {
        out.rows(sky.rows());
    }
    if let Some(folded) = &bake.folded {
        out.bytes.extend_from_slice(FOLDED);
        out.list(&folded.errors.numbers());
        out.low_rank(&folded.beyond_near);
    }
    out.bytes
}

impl Writer {
    fn rows(&mut self, rows: &Rows) {
        let out = self;
        out.list(&rows.near_offsets);
        out.indices(&rows.near);
        out.list(rows.near_weights.as_flattened());
        out.list(rows.near_steps.as_flattened());
        out.list(&rows.basis_offsets);
        out.list(&rows.coarse);
        out.columns(&rows.functions);
        out.list(rows.coefficients.as_flattened());
        out.list(rows.basis_steps.as_flattened());
        out.list(
            &rows
                .receivers
                .iter()
                .flat_map(|&(first, count)| [first, count])
                .collect::<Vec<u32>>(),
        );
    }

    fn low_rank(&mut self, operator: &LowRank) {
        self.list(&operator.scales);
        self.list(&[operator.component_count() as u32]);
        self.rows(&operator.components);
        self.rows(&operator.rows);
    }

    fn slices(&mut self, slices: &Slices) {
        self.list(&slices.receivers);
        self.list(&slices.scales);
        self.list(&[slices.far.function_count as u32]);
        self.rows(&slices.components);
        self.rows(&slices.near);
        self.rows(&slices.far);
    }

    fn paper_rows(&mut self, rows: &PaperRows) {
        self.list(&rows.offsets);
        self.indices(&rows.functions);
        self.list(&rows.coefficients);
        self.list(&[rows.step]);
        self.list(&rows.alone.iter().map(|&a| u8::from(a)).collect::<Vec<_>>());
    }
}

fn decode_payload(payload: &[u8]) -> Result<Bake, FileError> {
    let mut input = Reader { rest: payload };
    let head = input.list::<u8>()?;
    let [scheme, partitioner, parts @ ..] = head.as_slice() else {
        return Err(FileError::Damaged);
    };
    let (scheme, partitioner) = (*scheme, *partitioner);
    let scheme = Scheme::ALL.into_iter().find(|s| s.tag() == scheme);
    let partitioner = Partitioner::ALL
        .into_iter()
        .find(|p| p.tag() == partitioner);
    let (Some(scheme), Some(partitioner)) = (scheme, partitioner) else {
        return Err(FileError::Inconsistent("a scheme that does not exist"));
    };
    let rays = *input.list::<u32>()?.first().ok_or(FileError::Damaged)?;
    let threshold = *input.list::<f32>()?.first().ok_or(FileError::Damaged)?;
    let shares = input.list::<f64>()?;
    let &[
        arrived_share,
        escaped_share,
        senders_per_group,
        largest_eigenvalue,
        energy_mean,
        energy_worst,
    ] = shares.as_slice()
    else {
        return Err(FileError::Damaged);
    };
    let errors = ErrorParts::from_numbers(&input.list()?).ok_or(FileError::Damaged)?;
    let error_asked = match input.list::<f64>()?.as_slice() {
        [] => None,
        &[error] => Some(error),
        _ => return Err(FileError::Damaged),
    };
    let mut stats = BakeStats {
        folding: None,
        error_asked,
        errors,
        scheme,
        partitioner,
        rays,
        threshold,
        arrived_share,
        escaped_share,
        senders_per_group,
        largest_eigenvalue,
        energy_mean,
        energy_worst,
    };
    let backs: Vec<bool> = input.list::<u8>()?.into_iter().map(|b| b != 0).collect();

    let open_points: Vec<u8> = input.list()?;
    let (members, sizes, counts) = (
        input.list::<u32>()?,
        input.list::<u32>()?,
        input.list::<u32>()?,
    );
    let (values, masses) = (input.list::<f32>()?, input.list::<f32>()?);
    let basis = Basis::from_lists(members, &sizes, &counts, values)
        .and_then(|basis| basis.with_masses(masses))
        .map_err(FileError::Inconsistent)?;
    let back_count = backs.iter().filter(|&&b| b).count();
    if backs.len() + back_count != basis.slot_count() || open_points.len() != basis.slot_count() {
        return Err(FileError::Inconsistent(
            "sides and vertices of unequal number",
        ));
    }

    let slot_count = basis.slot_count();
    let operator = match scheme {
        Scheme::Relume => {
            let operator = input.low_rank(basis.function_count(), slot_count)?;
            Operator::LowRank(Box::new(operator))
        }
        Scheme::Paper => Operator::Paper(input.paper_rows(basis.function_count(), slot_count)?),
    };
    let slices = if parts.contains(&SLICES_PART) {
        Some(input.slices(basis.function_count(), slot_count)?)
    } else {
        None
    };
    let sky = if input.rest.is_empty() || input.rest.starts_with(FOLDED) {
        None
    } else {
        let cells = super::sky::basis();
        let rows = input.rows(cells.slot_count(), cells.function_count(), slot_count)?;
        Some(Sky::new(cells, rows))
    };
    let folded = input.folded(&operator, &basis)?.map(Box::new);
    stats.folding = folded.as_ref().map(|folded| folded.errors);
    if input.rest.is_empty() {
        Ok(Bake {
            backs,
            open_points,
            basis,
            operator,
            sky,
            slices,
            folded,
            stats,
        })
    } else {
        Err(FileError::Damaged)
    }
}

impl Reader<'_> {
    fn low_rank(&mut self, functions: usize, slots: usize) -> Result<LowRank, FileError> {
        let scales = self.list()?;
        let &[components] = self.list::<u32>()?.as_slice() else {
            return Err(FileError::Damaged);
        };
        let components = components as usize;
        let operator = LowRank {
            scales,
            components: self.rows(0, functions, components)?,
            rows: self.rows(slots, components, slots)?,
        };
        let checked = operator.check(slots, functions);
        checked.map_err(FileError::Inconsistent)?;
        Ok(operator)
    }

    /// Folded bounces, if what is left begins with them.
    fn folded(&mut self, near: &Operator, basis: &Basis) -> Result<Option<Folded>, FileError> {
        let (Some(rest), Operator::LowRank(near)) = (self.rest.strip_prefix(FOLDED), near) else {
            return Ok(None);
        };
        self.rest = rest;
        let errors = LightErrors::from_numbers(&self.list()?).ok_or(FileError::Damaged)?;
        let folded = Folded {
            errors,
            beyond_near: self.low_rank(3 * basis.function_count(), basis.slot_count())?,
        };
        let checked = folded.check(near, basis);
        checked.map_err(FileError::Inconsistent)?;
        Ok(Some(folded))
    }

    /// Rows of `slot_count` receivers that name so many senders and functions.
    fn rows(
        &mut self,
        sender_count: usize,
        function_count: usize,
        slot_count: usize,
    ) -> Result<Rows, FileError> {
        let rows = Rows {
            sender_count,
            function_count,
            near_offsets: self.list()?,
            near: self.indices()?,
            near_weights: self.groups()?,
            near_steps: self.groups()?,
            basis_offsets: self.list()?,
            coarse: self.list()?,
            functions: self.columns()?,
            coefficients: self.groups()?,
            basis_steps: self.groups()?,
            receivers: self
                .list::<u32>()?
                .chunks_exact(2)
                .map(|pair| (pair[0], pair[1]))
                .collect(),
        };
        rows.check(slot_count).map_err(FileError::Inconsistent)?;
        Ok(rows)
    }

    fn slices(&mut self, functions: usize, slots: usize) -> Result<Slices, FileError> {
        let receivers = self.list::<u32>()?;
        let scales = self.list::<f32>()?;
        let &[components] = self.list::<u32>()?.as_slice() else {
            return Err(FileError::Damaged);
        };
        let (components, rows) = (components as usize, receivers.len() * HARMONICS);
        let slices = Slices {
            components: self.rows(0, scales.len(), components)?,
            near: self.rows(0, slots, rows)?,
            far: self.rows(0, components, rows)?,
            receivers,
            scales,
        };
        let checked = slices.check(slots, functions);
        checked.map_err(FileError::Inconsistent)?;
        Ok(slices)
    }

    /// Lists of `slot_count` receivers that name so many functions.
    fn paper_rows(
        &mut self,
        function_count: usize,
        slot_count: usize,
    ) -> Result<PaperRows, FileError> {
        let rows = PaperRows {
            function_count,
            offsets: self.list()?,
            functions: self.indices()?,
            coefficients: self.list()?,
            step: *self.list()?.first().ok_or(FileError::Damaged)?,
            alone: self.list::<u8>()?.into_iter().map(|a| a != 0).collect(),
        };
        rows.check(slot_count).map_err(FileError::Inconsistent)?;
        Ok(rows)
    }
}
