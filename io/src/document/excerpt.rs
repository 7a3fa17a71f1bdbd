//! Values in messages, which have at most a line of them.

/// Characters of a value that a message shows.
const SHOWN: usize = 60;
/// Characters of a whole message.
const MESSAGE: usize = 1500;

/// The beginning of a text, without line breaks and other control characters.
pub(crate) fn excerpt(text: &str) -> String {
    cut(text.chars().flat_map(visible), SHOWN)
}

/// A message without its end if it is longer than anybody reads.
pub(crate) fn bounded(message: &str) -> String {
    cut(message.chars(), MESSAGE)
}

fn cut(mut characters: impl Iterator<Item = char>, most: usize) -> String {
    let mut shown: String = characters.by_ref().take(most).collect();
    if characters.next().is_some() {
        shown += "...";
    }
    shown
}

/// A character, escaped if it is one of control.
fn visible(character: char) -> impl Iterator<Item = char> {
    let escaped = character.is_control().then(|| character.escape_default());
    let plain = escaped.is_none().then_some(character);
    escaped.into_iter().flatten().chain(plain)
}
