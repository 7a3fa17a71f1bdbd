use super::*;
use serde::Deserialize;

#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Scene {
    a: Option<f64>,
    b: Option<[f64; 3]>,
    #[serde(default)]
    rows: Vec<[u64; 2]>,
    section: Option<Inner>,
    #[serde(default)]
    list: Vec<Inner>,
    word: Option<Word>,
    rate: Option<NumberOr<Vec<[f64; 2]>>>,
    flag: Option<bool>,
    small: Option<u8>,
    signed: Option<i32>,
    name: Option<String>,
}

#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Inner {
    x: f64,
}

#[derive(Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Word {
    One,
    Two,
}

fn read(text: &str) -> Result<Scene, String> {
    Node::of_toml(text).unwrap().read().map_err(|mismatch: TypeMismatch| mismatch.in_words("a scene"))
}

fn read_json(text: &str) -> Result<Scene, String> {
    let node = Node::of_json(text).map_err(|error| error.to_string())?;
    node.read().map_err(|mismatch: TypeMismatch| mismatch.in_words("a case"))
}

#[test]
fn values_are_read() {
    let text = "a = 1\nb = [1, 2.5, -3]\nrows = [[0, 1], [2, 3]]\nsection.x = 2\nword = 'two'\nsmall = 0x10\n\
                signed = -3\nrate = [[0, 1]]\nflag = true\nname = 'x'\n[[list]]\nx = 1e3\n";
    let scene = read(text).unwrap();
    assert_eq!((scene.a, scene.b, &scene.rows), (Some(1.0), Some([1.0, 2.5, -3.0]), &vec![[0, 1], [2, 3]]));
    assert_eq!((scene.section, scene.list), (Some(Inner { x: 2.0 }), vec![Inner { x: 1000.0 }]));
    assert_eq!((scene.word, scene.small, scene.signed), (Some(Word::Two), Some(16), Some(-3)));
    assert_eq!(scene.rate, Some(NumberOr::Other(vec![[0.0, 1.0]])));
    assert_eq!(read("rate = 2").unwrap().rate, Some(NumberOr::Number(2.0)));
    assert_eq!(read_json(r#"{"a": null, "b": [1, 2, 3]}"#).unwrap().b, Some([1.0, 2.0, 3.0]));
}

#[test]
fn nothing_is_dropped_or_converted() {
    for (text, message) in [
        ("b = [1, 2]", "b has the wrong type: found a list of length 2, expected a list of 3 numbers"),
        ("b = [1, 2, 3, 4]", "b has the wrong type: found a list of length 4, expected a list of 3 numbers"),
        (
            "rows = [[0, 1], [0, 1, 2]]",
            "rows[1] has the wrong type: found a list of length 3, expected a list of 2 numbers",
        ),
        ("rate = [[0, 1, 2]]", "rate[0] has the wrong type: found a list of length 3, expected a list of 2 numbers"),
        ("rate = [[0, 1], [0]]", "rate[1] has the wrong type: found a list of length 1, expected a list of 2 numbers"),
        ("section = [1.0]", "section has the wrong type: found a list of length 1, expected a section of keys"),
        ("list = [[1.0]]", "list[0] has the wrong type: found a list of length 1, expected a section of keys"),
        ("list = {x = 1}", "list has the wrong type: found a section of keys, expected a list"),
        ("section = {x = 1, y = 2}", "section.y is not a key of a scene; did you mean \"x\"? Known here: x"),
        ("section = {}", "section.x is missing"),
        ("a = true", "a has the wrong type: found true, expected a number"),
        ("a = '1'", "a has the wrong type: found \"1\", expected a number"),
        ("a = 1979-05-27", "a has the wrong type: found 1979-05-27, expected a number"),
        ("flag = 1", "flag has the wrong type: found 1, expected true or false"),
        ("flag = 'yes'", "flag has the wrong type: found \"yes\", expected true or false"),
        ("small = 256", "small has the wrong type: found 256, expected a whole number from 0 to 255"),
        ("small = 1.0", "small has the wrong type: found 1.0, expected a whole number, 0 or more"),
        ("small = -1", "small has the wrong type: found -1, expected a whole number, 0 or more"),
        ("name = 5", "name has the wrong type: found 5, expected text in quotes"),
        ("word = 1", "word has the wrong type: found 1, expected one of the words one, two"),
        ("word = 'ne'", "word is \"ne\"; did you mean \"one\"? Known here: one, two"),
        (
            "\"a b c d\" = 1",
            "\"a b c d\" is not a key of a scene; known here: a, b, rows, section, list, word, rate, flag, small, \
             signed, name",
        ),
        (
            "rate = 'x'",
            "rate has the wrong type: found \"x\", expected a number or a table of times and rates, as [[0.0, 1.0], \
             [5.0, -1.0]]",
        ),
    ] {
        assert_eq!(read(text).unwrap_err(), message);
    }
    let rounded = read("a = 9007199254740993").unwrap_err();
    assert!(rounded.contains("a number that 64 bits hold without rounding it"), "{rounded}");
    assert!(read("a = 9007199254740992").is_ok() && read("a = 9007199254740993.0").is_ok());
}

#[test]
fn json_is_read_as_strictly() {
    assert!(read_json(r#"{"a": 1, "a": 2}"#).unwrap_err().contains("a is there twice"));
    assert!(read_json(r#"{"section": {"x": 1, "x": 2}}"#).unwrap_err().contains("x is there twice"));
    assert_eq!(
        read_json("[1]").unwrap_err(),
        "a case has the wrong type: found a list of length 1, expected a section of keys"
    );
    assert_eq!(
        read_json(r#"{"flag": null, "rows": null}"#).unwrap_err(),
        "rows has the wrong type: found null, expected a list"
    );
}

#[test]
fn messages_have_a_line_of_a_value() {
    let long = "x".repeat(6_000_000);
    for text in [format!("a = '{long}'"), format!("word = '{long}'"), format!("{long} = 1")] {
        let message = read(&text).unwrap_err();
        assert!(message.contains("xxx...") && message.len() < 400, "{}", &message[..400.min(message.len())]);
    }
    assert!(read("name = [\"\"\"a\nb\"\"\"]\na = \"\"\"a\nb\"\"\"").unwrap_err().contains(r"a\nb"));
}

#[test]
fn keys_have_places() {
    let text = "a = 1\n[b]\nc = [1, 2]\n[[d]]\ne = 'x'\n[[d]]\ne = 'y'\n";
    let document = Node::of_toml(text).unwrap();
    assert_eq!(document.get("a"), document.get("a"));
    let line_of = |key: &str| document.find(key).map(|place| line(text, place));
    assert_eq!((line_of("a"), line_of("b.c"), line_of("d[1].e")), (Some(1), Some(3), Some(7)));
    assert_eq!(line_of("b.missing"), line_of("b"), "the parent's");
    assert_eq!(line_of("missing"), None);
}
