//! Compares a scene file with the schema: unknown and missing keys, wrong types, units, ranges.

use serde_json::Value as Schema;
use toml::de::DeValue;

use super::error::{Mistakes, SceneError};
use super::quantity::{self, Unit};
use super::rule::{
    alternatives, choice, example, keys, required, same_type, unit_of, wording, words,
};
use super::schema::{self, NAME};
use super::spelling::{ALIKE, beside, is_printable, nearest, printable};
use super::tree::{Table, Tree, Value, dotted, kind, number};

/// From here on not every whole number is a 64-bit float, as which it is shown.
const EXACT: f64 = 9007199254740992.0;

/// All mistakes of the whole file.
pub fn check(tree: &Tree<'_>, schema: &Schema) -> Mistakes {
    let mut check = Check {
        tree,
        root: schema,
        found: Mistakes::default(),
    };
    check.value(&tree.root, "", schema);
    check.found
}

struct Check<'a> {
    tree: &'a Tree<'a>,
    root: &'a Schema,
    found: Mistakes,
}

impl Check<'_> {
    fn value(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        if schema.as_bool() == Some(true) {
            return;
        }
        if words(schema).is_some() {
            return self.word(value, key, schema);
        }
        if let Some(unit) = unit_of(schema) {
            return self.quantity(value, key, schema, unit);
        }
        if let Some(kinds) = alternatives(schema) {
            return self.either(value, key, &kinds);
        }
        match schema["type"].as_str() {
            Some("object") => self.table(value, key, schema),
            Some("array") => self.list(value, key, schema),
            Some("string") => self.text(value, key, schema),
            Some("integer") => self.count(value, key, schema),
            Some("boolean") if value.get_ref().is_bool() => {}
            Some("boolean") => self.unfit(value, key, "true or false"),
            _ => match number(value.get_ref()) {
                Some(given) => self.within(value, key, schema, given),
                None => self.unfit(value, key, "a number without a unit"),
            },
        }
    }

    fn fault(&mut self, value: &Value<'_>, key: &str, problem: &str, remedy: &str) {
        let fault = self.tree.fault_of(value, key, problem, remedy);
        self.found.add(fault);
    }

    fn unfit(&mut self, value: &Value<'_>, key: &str, wanted: &str) {
        let problem = format!("is {}", kind(value.get_ref()));
        self.fault(value, key, &problem, &format!("write {wanted}"));
    }

    fn table(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        let Some(table) = value.get_ref().as_table() else {
            return self.unfit(value, key, "a table");
        };
        if let Some(each) = schema["patternProperties"].get(NAME) {
            return self.named(value, table, key, each);
        }
        if schema["additionalProperties"].is_object() {
            for (name, inner) in table {
                let key = dotted(key, &printable(name.get_ref()));
                self.value(inner, &key, &schema["additionalProperties"]);
            }
            return;
        }
        let known = keys(schema);
        let mut meant = Vec::new();
        for (name, inner) in table {
            let path = dotted(key, name.get_ref());
            match schema["properties"].get(name.get_ref().as_ref()) {
                Some(schema) => self.value(inner, &path, schema),
                None => {
                    let place = self.tree.place(name.span().start);
                    let name = name.get_ref();
                    let guess = self.guess(name, key, &known);
                    let question = guess.as_ref().map(|key| format!("did you mean `{key}`? "));
                    let question = question.unwrap_or_default();
                    self.found.add(SceneError::UnknownKey {
                        place,
                        key: dotted(key, &printable(name)),
                        remedy: format!("{question}known here: {}", known.join(", ")),
                        nearest: guess.clone(),
                    });
                    meant.extend(guess);
                }
            }
        }
        // A misspelled key is not also missing.
        let is_meant = |name: &str| meant.contains(&dotted(key, name));
        let is_there = |name: &str| table.keys().any(|given| given.get_ref() == name);
        for name in required(schema) {
            if !is_there(name) && !is_meant(name) {
                let property = &schema["properties"][name];
                let about = property["description"].as_str().unwrap_or("");
                let about = about.replace('\n', " ");
                let remedy = format!("{about} Write {}", example(name, property));
                self.found.add(SceneError::Missing {
                    place: self.tree.place(value.span().start),
                    key: dotted(key, name),
                    remedy,
                });
            }
        }
        let choice = choice(schema);
        if !choice.iter().any(|name| is_meant(name)) {
            self.exactly_one(value, table, key, &choice);
        }
    }

    fn exactly_one(&mut self, value: &Value<'_>, table: &Table<'_>, key: &str, choice: &[&str]) {
        if choice.is_empty() {
            return;
        }
        let is_one = |name: &str| choice.contains(&name);
        let mut given = table.iter().filter(|(name, _)| is_one(name.get_ref()));
        let remedy = format!("give exactly one of {}", choice.join(", "));
        match (given.next(), given.next()) {
            (Some(_), None) => {}
            (None, _) => self.found.add(SceneError::Missing {
                place: self.tree.place(value.span().start),
                key: dotted(key, choice[0]),
                remedy,
            }),
            (Some((first, _)), Some((second, inner))) => {
                let path = dotted(key, second.get_ref());
                let problem = format!("`{}` is given already", first.get_ref());
                self.fault(inner, &path, &problem, &remedy);
            }
        }
    }

    fn named(&mut self, value: &Value<'_>, table: &Table<'_>, key: &str, each: &Schema) {
        if table.is_empty() {
            let remedy = "add a table [body.NAME] for each";
            self.fault(value, key, "has 0 bodies", remedy);
        }
        for (name, inner) in table {
            let text = name.get_ref();
            let letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-".contains(c);
            if text.chars().all(letter) && text.starts_with(|c: char| c.is_ascii_lowercase()) {
                match self.meant(text, inner, table, each) {
                    None => self.value(inner, &dotted(key, text), each),
                    Some(other) => self.found.add(SceneError::UnknownKey {
                        place: self.tree.place(name.span().start),
                        key: dotted(key, text),
                        remedy: format!(
                            "did you mean `{}`? A new one needs one of {}",
                            dotted(key, other),
                            choice(each).join(", ")
                        ),
                        nearest: Some(dotted(key, other)),
                    }),
                }
                continue;
            }
            self.found.add(SceneError::Value {
                place: self.tree.place(name.span().start),
                key: dotted(key, &printable(text)),
                value: toml::Value::String(printable(text)).to_string(),
                problem: "is not a name".to_string(),
                remedy: "use lower-case letters, digits, - and _, a letter first".to_string(),
            });
        }
    }

    /// The table whose name was probably meant by `name`: one like it, where `inner` lacks what
    /// each must have.
    fn meant<'t>(
        &self,
        name: &str,
        inner: &Value<'_>,
        tables: &'t Table<'_>,
        each: &Schema,
    ) -> Option<&'t str> {
        let choice = choice(each);
        let is_whole = |value: &Value<'_>| {
            let table = value.get_ref().as_table();
            let keys = table.into_iter().flat_map(Table::keys);
            keys.into_iter()
                .any(|key| choice.iter().any(|known| key.get_ref() == known))
        };
        if choice.is_empty() || is_whole(inner) {
            return None;
        }
        let others = tables.iter().filter(|(_, value)| is_whole(value));
        let others = others.map(|(other, _)| other.get_ref().as_ref());
        nearest(name, others)
            .filter(|(_, likeness)| *likeness >= ALIKE)
            .map(|(other, _)| other)
    }

    fn list(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        let Some(items) = value.get_ref().as_array() else {
            return self.unfit(value, key, &wording(schema));
        };
        let bound = |word: &str| schema[word].as_u64();
        let count = items.len() as u64;
        let (least, most) = (bound("minItems"), bound("maxItems"));
        if least.is_some_and(|least| count < least) || most.is_some_and(|most| count > most) {
            let remedy = match (least, most) {
                (Some(least), Some(most)) if least == most => format!("give {least}"),
                (Some(least), Some(most)) => {
                    format!("give {least} to {most}, one for each dimension")
                }
                _ => "give fewer".to_string(),
            };
            self.fault(value, key, &format!("has {count} entries"), &remedy);
        }
        for (index, item) in items.iter().enumerate() {
            self.value(item, &format!("{key}[{index}]"), &schema["items"]);
        }
    }

    fn text(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        let Some(text) = value.get_ref().as_str() else {
            return self.unfit(value, key, "a string");
        };
        if !text.chars().all(is_printable) {
            let problem = "has a control character, which terminals interpret";
            return self.fault(value, key, problem, "leave it out; a text is one line");
        }
        // The only pattern without a unit is that of a colour.
        if schema["pattern"].is_string() {
            let digits = text.strip_prefix('#').unwrap_or("");
            if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
                let remedy = "write red, green, blue as \"#1f77b4\"";
                self.fault(value, key, "is not a colour", remedy);
            }
        }
    }

    fn count(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        let least = schema["minimum"].as_f64().unwrap_or(0.0);
        let most = schema["maximum"].as_f64().unwrap_or(f64::INFINITY);
        let most = most.min(EXACT);
        let wanted = format!("a whole number from {least} to {most}");
        match value.get_ref() {
            DeValue::Integer(_) => {
                let given = number(value.get_ref());
                if !given.is_some_and(|given| (least..=most).contains(&given)) {
                    self.fault(value, key, "is out of range", &format!("write {wanted}"));
                }
            }
            _ => self.unfit(value, key, &wanted),
        }
    }

    fn quantity(&mut self, value: &Value<'_>, key: &str, schema: &Schema, unit: Unit) {
        let problem = match value.get_ref() {
            DeValue::String(text) => match quantity::parse(text, unit) {
                Ok(given) => return self.within(value, key, schema, given),
                Err(error) => error.to_string(),
            },
            other => match number(other) {
                Some(given) => return self.within(value, key, schema, given),
                None => format!("is {} where {} is expected", kind(other), unit.name()),
            },
        };
        let names: Vec<&str> = unit.spellings().iter().map(|(name, _)| *name).collect();
        let remedy = format!(
            "write for example {}; units: {}",
            unit.example(),
            names.join(", ")
        );
        self.fault(value, key, &problem, &remedy);
    }

    fn within(&mut self, value: &Value<'_>, key: &str, schema: &Schema, given: f64) {
        let bound = |word: &str| schema[word].as_f64();
        let (low, high) = (bound("minimum"), bound("maximum"));
        let above = bound("exclusiveMinimum");
        let holds = given.is_finite()
            && above.is_none_or(|above| given > above)
            && low.is_none_or(|low| given >= low)
            && high.is_none_or(|high| given <= high);
        if holds {
            return;
        }
        let wording = match (above, low, high) {
            (Some(_), ..) => "above zero".to_string(),
            (_, Some(low), Some(high)) => format!("between {low} and {high}"),
            (_, Some(0.0), None) => "zero or above".to_string(),
            (_, Some(low), None) => format!("{low} or above"),
            _ => "finite".to_string(),
        };
        let remedy = format!("it must be {wording}");
        self.fault(value, key, "is out of range", &remedy);
    }

    fn word(&mut self, value: &Value<'_>, key: &str, schema: &Schema) {
        let known = words(schema).unwrap_or_default();
        let quoted: Vec<String> = known.iter().map(|word| format!("{word}")).collect();
        let quoted = quoted.join(", ");
        if let Some(Schema::Number(_)) = known.first() {
            let given = number(value.get_ref());
            if !known.iter().any(|word| word.as_f64() == given) {
                let remedy = format!("write {}", quoted.replace(", ", " or "));
                self.fault(value, key, "is not known", &remedy);
            }
            return;
        }
        let Some(given) = value.get_ref().as_str() else {
            return self.unfit(value, key, &format!("one of {quoted}"));
        };
        let known: Vec<&str> = known.iter().filter_map(|word| word.as_str()).collect();
        if known.contains(&given) {
            return;
        }
        let guess = nearest(given, known.into_iter()).filter(|(_, likeness)| *likeness >= ALIKE);
        let guess = guess.map(|(word, _)| format!("did you mean \"{word}\"? "));
        let remedy = format!("{}known are {quoted}", guess.unwrap_or_default());
        self.fault(value, key, "is not known", &remedy);
    }

    /// Reports the mistakes of the alternative whose TOML type matches, if there is one.
    fn either(&mut self, value: &Value<'_>, key: &str, kinds: &[Schema]) {
        let mut fitting = None;
        for schema in kinds {
            let mut own = Check {
                tree: self.tree,
                root: self.root,
                found: Mistakes::default(),
            };
            own.value(value, key, schema);
            match own.found.told() {
                Ok(()) => return,
                Err(mistake) if same_type(value, schema) => fitting = Some(mistake),
                Err(_) => {}
            }
        }
        match fitting {
            Some(mistake) => self.found.add(mistake),
            None => {
                let wanted: Vec<String> = kinds.iter().map(wording).collect();
                self.unfit(value, key, &wanted.join(", or "));
            }
        }
    }

    /// The known key most similar to an unknown one, if it is similar enough.
    fn guess(&self, given: &str, table: &str, known: &[&str]) -> Option<String> {
        match nearest(given, known.iter().copied()) {
            Some((name, likeness)) if likeness >= ALIKE => Some(dotted(table, name)),
            _ => beside(given, table, &schema::keys(self.root)).map(|(key, _)| key),
        }
    }
}
