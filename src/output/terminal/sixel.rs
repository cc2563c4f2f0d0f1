//! DEC's sixels (VT330/VT340 programmer reference, chapter 14): bands of six
//! lines of pixels, colour by colour, of at most 256 colours.
//!
//! Our own encoder, because the crates for it bring a quantiser with dozens of
//! packages: the colours are chosen by median cut (Heckbert, "Color image
//! quantization for frame buffer display", 1982) over levels of 5 bits, and an
//! ordered pattern of half a step hides the steps that 5 bits leave. Pictures of
//! no more than 256 colours keep theirs, but for the protocol's whole percents.

use super::cells::Levels;
use super::protocol::{PixelPicture, Way};
use crate::output::OutputError;

pub(super) const WAY: Way = Way {
    name: "sixel",
    draw,
    remove: b"",
};

/// Most colours that terminals give a picture.
const MOST_COLOURS: usize = 256;
/// Lines of pixels in a band.
const BAND: usize = 6;
/// Equal columns from which on a count is shorter.
const SHORTEST_RUN: usize = 4;
/// Levels of 8 bits a step of 5 bits.
const STEP: u8 = 8;
/// Thresholds of an ordered pattern of 4 x 4 (Bayer 1973), spread over a step.
const PATTERN: [[u8; 4]; 4] = [[0, 4, 1, 5], [6, 2, 7, 3], [1, 5, 0, 4], [7, 3, 6, 2]];

/// A picture as indices into its colours.
struct Indexed {
    colours: Vec<Levels>,
    /// Row by row.
    pixels: Vec<u8>,
}

/// Pixels that are not set stay as they are (`P2 = 1`): all are set.
fn draw(picture: &PixelPicture) -> Result<Vec<u8>, OutputError> {
    let (width, height) = (picture.levels.width(), picture.levels.height());
    let (pixels, _) = picture.levels.bytes().as_chunks::<3>();
    let indexed = exact(pixels).unwrap_or_else(|| quantised(pixels, width as usize));
    let mut text = format!("\x1bP0;1;0q\"1;1;{width};{height}");
    for (index, colour) in indexed.colours.iter().enumerate() {
        let [red, green, blue] = colour.map(|level| (u32::from(level) * 100 + 127) / 255);
        text.push_str(&format!("#{index};2;{red};{green};{blue}"));
    }
    for (place, band) in indexed.pixels.chunks(BAND * width as usize).enumerate() {
        if place > 0 {
            text.push('-');
        }
        push_band(band, width as usize, &mut text);
    }
    text.push_str("\x1b\\");
    Ok(text.into_bytes())
}

/// The picture in its own colours, if they are few enough.
fn exact(pixels: &[Levels]) -> Option<Indexed> {
    let mut colours: Vec<Levels> = Vec::new();
    for pixel in pixels {
        if let Err(place) = colours.binary_search(pixel) {
            if colours.len() == MOST_COLOURS {
                return None;
            }
            colours.insert(place, *pixel);
        }
    }
    let index = |pixel| colours.binary_search(pixel).unwrap_or_default() as u8;
    let pixels = pixels.iter().map(index).collect();
    Some(Indexed { colours, pixels })
}

/// The picture in colours that stand for all of its own.
fn quantised(pixels: &[Levels], width: usize) -> Indexed {
    let bins: Vec<usize> = (0..)
        .zip(pixels)
        .map(|(index, &pixel)| bin(pixel, index % width, index / width))
        .collect();
    let mut counts = vec![0_u64; 1 << 15];
    for &bin in &bins {
        counts[bin] += 1;
    }
    let mut index_of_bin = vec![0_u8; counts.len()];
    let mut colours = Vec::new();
    for group in median_cut(&counts) {
        for &bin in &group {
            // At most 256 groups.
            index_of_bin[bin] = colours.len() as u8;
        }
        colours.push(mean(&group, &counts));
    }
    let pixels = bins.into_iter().map(|bin| index_of_bin[bin]).collect();
    Indexed { colours, pixels }
}

/// Levels of 5 bits each, as one number; which of two steps, the pattern says.
fn bin([red, green, blue]: Levels, x: usize, y: usize) -> usize {
    let offset = PATTERN[y % 4][x % 4];
    // Half a step down, so that the mean over a pattern stays.
    let step =
        |level: u8| usize::from(level.saturating_sub(STEP / 2).saturating_add(offset) / STEP);
    step(red) << 10 | step(green) << 5 | step(blue)
}

/// Steps of a channel (0 red, 1 green, 2 blue) of a bin.
fn channel(bin: usize, channel: usize) -> usize {
    bin >> (10 - 5 * channel) & 31
}

/// The bins that occur, in at most [`MOST_COLOURS`] groups: again and again the
/// group with the largest product of pixels and width is cut at its median.
fn median_cut(counts: &[u64]) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..counts.len()).filter(|&bin| counts[bin] > 0).collect();
    let mut groups = vec![(urgency(&all, counts), all)];
    while groups.len() < MOST_COLOURS {
        let most = groups.iter().map(|(urgency, _)| *urgency).max();
        let Some(place) = groups
            .iter()
            .position(|(urgency, _)| Some(*urgency) == most)
        else {
            break;
        };
        if groups[place].0 == 0 {
            break;
        }
        let (_, group) = groups.swap_remove(place);
        let (low, high) = cut(group, counts);
        groups.extend([low, high].map(|half| (urgency(&half, counts), half)));
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// The channel in which a group is widest, and by how many steps.
fn widest(group: &[usize]) -> (usize, usize) {
    let width = |of: usize| {
        let steps = || group.iter().map(|&bin| channel(bin, of));
        steps().max().unwrap_or(0) - steps().min().unwrap_or(0)
    };
    let widths = [0, 1, 2].map(width);
    let most = widths.into_iter().max().unwrap_or(0);
    let of = widths.iter().position(|&width| width == most);
    (of.unwrap_or(0), most)
}

/// How much a group asks for being cut; 0 of a single bin.
fn urgency(group: &[usize], counts: &[u64]) -> u64 {
    let pixels: u64 = group.iter().map(|&bin| counts[bin]).sum();
    pixels * widest(group).1 as u64
}

/// Two parts of a group of at least two bins, none empty, with about as many
/// pixels each.
fn cut(mut group: Vec<usize>, counts: &[u64]) -> (Vec<usize>, Vec<usize>) {
    let (of, _) = widest(&group);
    group.sort_by_key(|&bin| (channel(bin, of), bin));
    let half = group.iter().map(|&bin| counts[bin]).sum::<u64>() / 2;
    let mut sum = 0;
    let place = group.iter().position(|&bin| {
        sum += counts[bin];
        sum > half
    });
    let place = place.unwrap_or(0).clamp(1, group.len() - 1);
    let high = group.split_off(place);
    (group, high)
}

/// Mean colour of a group, weighted by pixels.
fn mean(group: &[usize], counts: &[u64]) -> Levels {
    let pixels: u64 = group.iter().map(|&bin| counts[bin]).sum();
    [0, 1, 2].map(|of| {
        // A bin stands for the middle of its step; black and white are themselves.
        let level = |bin: usize| (channel(bin, of) * 255 / 31) as u64;
        let sum: u64 = group.iter().map(|&bin| counts[bin] * level(bin)).sum();
        ((sum + pixels / 2) / pixels.max(1)) as u8
    })
}

/// Appends a band: every colour that is in it over its whole width, one over the
/// other.
fn push_band(band: &[u8], width: usize, text: &mut String) {
    let mut is_in = [false; MOST_COLOURS];
    for &pixel in band {
        is_in[usize::from(pixel)] = true;
    }
    let mut bits = vec![0_u8; width];
    let colours = (0..=u8::MAX).filter(|&colour| is_in[usize::from(colour)]);
    for (place, colour) in colours.enumerate() {
        bits.fill(0);
        for (line, pixels) in band.chunks(width).enumerate() {
            for (bits, &pixel) in bits.iter_mut().zip(pixels) {
                *bits |= u8::from(pixel == colour) << line;
            }
        }
        if place > 0 {
            text.push('$');
        }
        text.push_str(&format!("#{colour}"));
        push_runs(&bits, text);
    }
}

/// Appends columns of six pixels, runs of equal ones by their count; nothing at
/// the end of the line is left out.
fn push_runs(bits: &[u8], text: &mut String) {
    let end = bits
        .iter()
        .rposition(|&bits| bits > 0)
        .map_or(0, |last| last + 1);
    for run in bits[..end].chunk_by(|a, b| a == b) {
        let letter = char::from(b'?' + run[0]);
        if run.len() < SHORTEST_RUN {
            text.extend(run.iter().map(|_| letter));
        } else {
            text.push_str(&format!("!{}{letter}", run.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::protocol::{Protocol, tiny};
    use super::*;

    fn sent(picture: &PixelPicture) -> String {
        String::from_utf8(Protocol::Sixel.encode(picture).unwrap()).unwrap()
    }

    #[test]
    fn a_tiny_picture_keeps_its_colours() {
        let picture = tiny(2, 1, &[255, 0, 0, 0, 0, 255]);
        assert_eq!(
            sent(&picture),
            "\x1b[2;3H\x1bP0;1;0q\"1;1;2;1#0;2;0;0;100#1;2;100;0;0#0?@$#1@\x1b\\"
        );
    }

    #[test]
    fn bands_have_six_lines_and_runs_a_count() {
        let mut levels = vec![0; 3 * 5 * 7];
        levels[3 * 5 * 6..].fill(51);
        assert_eq!(
            sent(&tiny(5, 7, &levels)),
            "\x1b[2;3H\x1bP0;1;0q\"1;1;5;7#0;2;0;0;0#1;2;20;20;20#0!5~-#1!5@\x1b\\"
        );
    }

    #[test]
    fn many_colours_become_few_that_are_near() {
        let (width, height) = (64, 64);
        let pixels: Vec<Levels> = (0..width * height)
            .map(|index| [(index % 64 * 4) as u8, (index / 64 * 4) as u8, 90])
            .collect();
        let indexed = quantised(&pixels, width);
        assert!((200..=MOST_COLOURS).contains(&indexed.colours.len()));
        let distance = |(pixel, &index): (&Levels, &u8)| {
            let colour = indexed.colours[usize::from(index)];
            let differences = pixel
                .iter()
                .zip(colour)
                .map(|(a, b)| u32::from(a.abs_diff(b)));
            differences.max().unwrap()
        };
        let all = || pixels.iter().zip(&indexed.pixels).map(distance);
        let (worst, sum) = (all().max().unwrap(), all().sum::<u32>());
        assert!(worst <= 26, "{worst}");
        assert!(
            sum < 9 * pixels.len() as u32,
            "{}",
            sum / pixels.len() as u32
        );
        assert_eq!(quantised(&pixels, width).pixels, indexed.pixels);
    }

    #[test]
    fn a_picture_of_one_tone_too_many_is_still_drawn() {
        let levels: Vec<u8> = (0..257_u32)
            .flat_map(|i| [i as u8, (i / 256) as u8, 7])
            .collect();
        assert!(exact(levels.as_chunks().0).is_none());
        let text = sent(&tiny(257, 1, &levels));
        assert!(
            text.ends_with("\x1b\\") && text.len() < 4_000,
            "{}",
            text.len()
        );
    }
}
