//! Values in messages, shortened to one line.

/// Largest number of characters of a value in a message.
const SHOWN: usize = 60;
/// Largest number of characters of a message.
const MESSAGE: usize = 1500;

/// Beginning of a text, without line breaks and other control characters.
pub fn excerpt(text: &str) -> String {
    cut(text.chars().flat_map(visible), SHOWN)
}

/// A message, cut if it is too long to be read.
pub fn bounded(message: &str) -> String {
    cut(message.chars(), MESSAGE)
}

fn cut(mut characters: impl Iterator<Item = char>, most: usize) -> String {
    let mut shown: String = characters.by_ref().take(most).collect();
    if characters.next().is_some() {
        shown += "...";
    }
    shown
}

/// A character, escaped if it is a control character.
fn visible(character: char) -> impl Iterator<Item = char> {
    let escaped = character.is_control().then(|| character.escape_default());
    let plain = escaped.is_none().then_some(character);
    escaped.into_iter().flatten().chain(plain)
}
