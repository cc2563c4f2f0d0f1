//! What the terminal can do: which colours it shows, which protocol for pixels,
//! how large a cell is.
//!
//! Comes in: the environment and what the terminal answers to a few questions.
//! Goes out: [`Abilities`]. Answers weigh more than the environment, which lies
//! as soon as a program runs behind another one, and a user's word more than
//! both. Nobody has to answer: what is not known is not used.

mod abilities;
mod answers;
mod environment;
mod late;
mod typed;

use std::time::Duration;

pub(crate) use abilities::{Abilities, decide};
pub use abilities::{ColourChoice, ProtocolChoice, UnknownChoice};
pub(crate) use answers::{Answers, Heard};
pub(crate) use environment::Environment;
pub(crate) use late::LateAnswers;
pub(crate) use typed::typed_events;

/// The questions, in an order in which late answers do least harm: an answer to
/// the last one is told from keys by everybody, and ends the one before it.
///
/// They are: what a colour of 24 bits has become (DECRQSS of SGR), whether kitty's
/// graphics are known, the terminal's name (XTVERSION), a cell's pixels, whether
/// frames can be synchronized (DECRQM), and what everyone answers: the primary
/// device attributes, among which 4 stands for sixel.
pub(crate) const QUESTIONS: &[u8] = b"\x1b[48;2;1;2;3m\x1bP$qm\x1b\\\x1b[m\
\x1b_Gi=7497068,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\
\x1b[>0q\x1b[16t\x1b[?2026$p\x1b[c";

/// How long an answer is waited for. A terminal on the same machine answers
/// within a few milliseconds.
pub(crate) const PATIENCE: Duration = Duration::from_millis(150);
/// How long over a network, where a round trip is often 200 ms; and how long once
/// a terminal has begun to answer.
pub(crate) const LONG_PATIENCE: Duration = Duration::from_millis(600);
