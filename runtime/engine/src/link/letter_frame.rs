//! Letters in binary form. The proof of a letter is computed with the key that sender and recipient share, and covers
//! the sessions of both (docs/src/reference/interfaces.md, 6.5).

use mdle_runtime::Nanos;

use super::bytes::{UnreadBytes, put_name};
use super::frame::{Challenge, FrameDraft, RefusedFrame, SharedKey, opened};
use super::letter::{Content, LONGEST_SENTENCE, LONGEST_TEXT, Letter, cut};
use crate::plans::When;

/// Magic number of a letter's frame.
const MAGIC: [u8; 4] = *b"MDLl";
/// Maximum length of a letter's frame, in bytes, without the four bytes of the length field. All other frames are
/// shorter.
pub const LONGEST_LETTER: usize = LONGEST_TEXT + 1024;
/// Numbers that identify the content of a letter: a plan, a refusal or an acceptance.
const PLAN: u8 = 0;
const REFUSAL: u8 = 1;
const ACCEPTANCE: u8 = 2;

/// Sender and recipient of a letter, with their sessions. The proof of the letter covers all of these.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Envelope {
    pub(super) from: String,
    pub(super) to: String,
    /// Session of the sender.
    pub(super) sent_in: u64,
    /// Session of the recipient. The letter is valid only in this session.
    pub(super) meant_for: u64,
    /// Time, since the start of the sender's session, at which the letter was posted.
    pub(super) sent: Nanos,
}

/// Returns `true` if `frame`, given without its length field, contains a letter: a plan for another robot, or an answer
/// to such a plan.
pub(super) fn is_letter(frame: &[u8]) -> bool {
    frame.starts_with(&MAGIC)
}

/// Returns the draft of a letter.
pub(super) fn written(envelope: &Envelope, letter: &Letter, key: &SharedKey) -> FrameDraft {
    let mut body = Vec::new();
    put_name(&mut body, &envelope.from);
    put_name(&mut body, &envelope.to);
    let numbers = [envelope.sent_in, envelope.meant_for, letter.number, envelope.sent.0];
    numbers.iter().for_each(|number| body.extend(number.to_le_bytes()));
    let text = match &letter.content {
        Content::Plan { when, text } => {
            body.extend([PLAN, when.number()]);
            cut(text, LONGEST_TEXT)
        }
        Content::Answer { of, is_accepted, sentence } => {
            body.push(if *is_accepted { ACCEPTANCE } else { REFUSAL });
            body.extend(of.to_le_bytes());
            cut(sentence, LONGEST_SENTENCE)
        }
    };
    body.extend(text.as_bytes());
    FrameDraft::new(MAGIC, None, body, key)
}

/// Parses the frame of a letter, given without its length field.
///
/// # Errors
/// Fails if the bytes are not a letter, or if its proof is not for this key and this challenge.
pub(super) fn read(frame: &[u8], key: &SharedKey, challenge: &Challenge) -> Result<(Envelope, Letter), RefusedFrame> {
    letter(&mut opened(MAGIC, frame, key, challenge)?).ok_or(RefusedFrame::Garbage)
}

fn letter(body: &mut UnreadBytes<'_>) -> Option<(Envelope, Letter)> {
    let (from, to) = (body.name()?, body.name()?);
    let (sent_in, meant_for, number, sent) = (body.number()?, body.number()?, body.number()?, Nanos(body.number()?));
    let [kind] = body.take()?;
    let content = match kind {
        PLAN => {
            let [when] = body.take()?;
            Content::Plan { when: When::of_number(when)?, text: body.text()? }
        }
        REFUSAL | ACCEPTANCE => {
            let (of, sentence) = (body.number()?, body.text()?);
            let sentence = cut(&sentence, LONGEST_SENTENCE).to_owned();
            Content::Answer { of, is_accepted: kind == ACCEPTANCE, sentence }
        }
        _ => return None,
    };
    let letter = Letter { from: from.clone(), number, content };
    Some((Envelope { from, to, sent_in, meant_for, sent }, letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters() -> [Letter; 2] {
        let plan = Content::Plan { when: When::AtomEnds, text: "{ Γ (bumper) }".to_owned() };
        let answer = Content::Answer { of: 7, is_accepted: true, sentence: String::new() };
        [plan, answer].map(|content| Letter { from: "ada".to_owned(), number: 3, content })
    }

    fn envelope() -> Envelope {
        Envelope { from: "ada".to_owned(), to: "bob".to_owned(), sent_in: 1, meant_for: u64::MAX, sent: Nanos(9) }
    }

    #[test]
    fn a_letter_is_read_as_it_was_written() {
        let key = SharedKey::of("pair");
        for letter in letters() {
            let frame = written(&envelope(), &letter, &key).frame(&Challenge::NONE);
            assert!(is_letter(&frame[4..]) && frame.len() < LONGEST_LETTER);
            assert_eq!(read(&frame[4..], &key, &Challenge::NONE), Ok((envelope(), letter)));
        }
    }

    #[test]
    fn any_other_bytes_are_no_letter() {
        let key = SharedKey::of("pair");
        let read = |frame: &[u8], key: &SharedKey| read(frame, key, &Challenge::NONE);
        for letter in letters() {
            let frame = written(&envelope(), &letter, &key).frame(&Challenge::NONE)[4..].to_vec();
            assert_eq!(read(&frame, &SharedKey::of("another")), Err(RefusedFrame::Key));
            for place in 0..frame.len() {
                let mut changed = frame.clone();
                changed[place] ^= 1;
                assert!(read(&changed, &key).is_err(), "byte {place}");
                assert!(read(&frame[..place], &key).is_err(), "the first {place} bytes");
            }
        }
    }

    #[test]
    fn a_long_text_is_cut_at_a_letter() {
        let key = SharedKey::of("pair");
        let plan = |text| Content::Plan { when: When::Now, text };
        let answer = |sentence| Content::Answer { of: 1, is_accepted: false, sentence };
        let of = |content| Letter { from: "ada".to_owned(), number: 1, content };
        let long = "Γ".repeat(LONGEST_TEXT);
        for (content, cut) in [
            (plan(format!("e{long}")), plan(format!("e{}", "Γ".repeat(LONGEST_TEXT / 2 - 1)))),
            (answer(format!("e{long}")), answer(format!("e{}", "Γ".repeat(LONGEST_SENTENCE / 2 - 1)))),
        ] {
            let frame = written(&envelope(), &of(content), &key).frame(&Challenge::NONE);
            assert!(frame.len() <= LONGEST_LETTER);
            assert_eq!(read(&frame[4..], &key, &Challenge::NONE), Ok((envelope(), of(cut))));
        }
        // A peer may send a longer sentence than this robot would.
        let mut body = written(&envelope(), &of(answer(String::new())), &key).frame(&Challenge::NONE).split_off(45);
        body.extend([b'x'; LONGEST_TEXT]);
        let frame = FrameDraft::new(MAGIC, None, body, &key).frame(&Challenge::NONE);
        let cut = of(answer("x".repeat(LONGEST_SENTENCE)));
        assert_eq!(read(&frame[4..], &key, &Challenge::NONE), Ok((envelope(), cut)));
    }
}
