//! Lists of a wrong length, tables in place of lists, and lists in place of tables.

use crate::tree::{self, TreeStep};
use proptest::prelude::*;
use toml::{Table, Value};

/// An edit of a list or a table.
#[derive(Debug, Clone, Copy)]
pub enum Misfit {
    /// Repeats the last item.
    Longer,
    /// Removes the last item.
    Shorter,
    /// Makes a list a table, and a table the list of its values.
    Exchanged,
}

/// Lists that may have any length.
const FREE: [&str; 9] =
    ["seeds", "viscosities", "rates", "area_fractions", "speeds", "pressures", "rate", "pairs", "particles"];

/// Any edit.
pub fn any_misfit() -> impl Strategy<Value = Misfit> {
    prop_oneof![3 => Just(Misfit::Longer), 1 => Just(Misfit::Shorter), 2 => Just(Misfit::Exchanged)]
}

/// Places at which an edit makes the input invalid.
pub fn candidates(tree: &Value, misfit: Misfit) -> Vec<Vec<TreeStep>> {
    let mut tree = tree.clone();
    let mut places = tree::places(&tree);
    places.retain(|place| tree::find(&mut tree, place).is_some_and(|value| fits(value, place, misfit)));
    places
}

fn fits(value: &Value, place: &[TreeStep], misfit: Misfit) -> bool {
    let is_free = matches!(place.last(), Some(TreeStep::Key(key)) if FREE.contains(&key.as_str()));
    match (value, misfit) {
        (Value::Array(list), _) if list.iter().any(Value::is_table) => false,
        (Value::Array(_) | Value::Table(_), Misfit::Exchanged) => true,
        (Value::Array(list), _) => !is_free && !list.is_empty(),
        _ => false,
    }
}

/// Applies an edit.
pub fn apply(tree: &mut Value, place: &[TreeStep], misfit: Misfit) {
    let Some(value) = tree::find(tree, place) else { return };
    match (&mut *value, misfit) {
        (Value::Array(list), Misfit::Longer) => list.extend(list.last().cloned()),
        (Value::Array(list), Misfit::Shorter) => drop(list.pop()),
        (Value::Array(list), Misfit::Exchanged) => {
            let named = |(item, value): (usize, &Value)| (["x", "y", "z", "w"][item % 4].to_owned(), value.clone());
            *value = Value::Table(list.iter().enumerate().map(named).collect::<Table>());
        }
        (Value::Table(table), _) => *value = Value::Array(table.values().cloned().collect()),
        _ => {}
    }
}

/// Last key of a place, which an error must name.
pub fn key(place: &[TreeStep]) -> &str {
    let key = |part: &TreeStep| matches!(part, TreeStep::Key(_));
    match place.iter().rfind(|part| key(part)) {
        Some(TreeStep::Key(key)) => key,
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(text: &str, misfit: Misfit) -> Vec<String> {
        let tree: Value = toml::from_str(text).unwrap();
        let change = |place: Vec<TreeStep>| {
            let mut after = tree.clone();
            apply(&mut after, &place, misfit);
            assert_ne!(after, tree, "{}", tree::path(&place));
            format!("{} {}", tree::path(&place), key(&place))
        };
        candidates(&tree, misfit).into_iter().map(change).collect()
    }

    #[test]
    fn every_list_and_table_is_changed() {
        let text = "rates = [1.0]\n[box]\nedges = [1, 2]\n[[species]]\nrows = [[1, 2], [3, 4]]\n";
        let lists = ["box.edges edges", "species[0].rows rows", "species[0].rows[0] rows", "species[0].rows[1] rows"];
        assert_eq!(changed(text, Misfit::Longer), lists);
        assert_eq!(changed(text, Misfit::Shorter), lists);
        assert_eq!(changed(text, Misfit::Exchanged).len(), lists.len() + 3);
    }

    #[test]
    fn no_value_of_a_list_is_lost() {
        let mut tree: Value = toml::from_str("a = [1, 2, 3]").unwrap();
        let place = candidates(&tree, Misfit::Exchanged).remove(0);
        apply(&mut tree, &place, Misfit::Exchanged);
        assert_eq!(tree::paths(&tree), ["a", "a.x", "a.y", "a.z"]);
    }
}
