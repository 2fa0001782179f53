//! A CSV with its origin, as a table in Markdown.

use std::path::Path;

/// A CSV file.
pub struct Table {
    /// Lines `# key: value` of its head.
    origin: Vec<(String, String)>,
    pub names: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn read(path: &Path) -> Result<Table, String> {
        let wrong = |what: String| format!("{}: {what}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        Table::parse(&text).map_err(wrong)
    }

    pub fn parse(text: &str) -> Result<Table, String> {
        let head = text.lines().take_while(|line| line.starts_with('#'));
        let origin: Option<Vec<_>> = head
            .map(|line| line.strip_prefix("# ")?.split_once(": "))
            .map(|pair| pair.map(|(key, value)| (key.to_string(), value.to_string())))
            .collect();
        let origin = origin.ok_or("a line of the head is not `# key: value`")?;
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let own = |record: &csv::StringRecord| record.iter().map(str::to_string).collect();
        let names = own(reader.headers().map_err(|error| error.to_string())?);
        let rows: Result<Vec<Vec<String>>, _> = reader
            .records()
            .map(|record| record.map(|record| own(&record)))
            .collect();
        let rows = rows.map_err(|error| error.to_string())?;
        if rows.iter().flatten().any(|cell| cell.contains('|')) {
            return Err("a cell has a `|`".to_string());
        }
        Ok(Table {
            origin,
            names,
            rows,
        })
    }

    /// Values of a key of the head.
    pub fn head<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a str> {
        let own = self.origin.iter().filter(move |(name, _)| name == key);
        own.map(|(_, value)| value.as_str())
    }

    /// Where the figures come from, in a line.
    pub fn foot(&self, link: &str) -> String {
        let name = link.rsplit('/').next().unwrap_or(link);
        let code = |command: &str| match command.starts_with("see ") {
            true => command.to_string(),
            false => format!("`{command}`"),
        };
        let commands: Vec<String> = self.head("command").map(code).collect();
        let commands = match commands.is_empty() {
            true => "command not recorded".to_string(),
            false => commands.join(", "),
        };
        let join = |key| self.head(key).collect::<Vec<_>>().join("; ");
        let mut foot = format!(
            "[`{name}`]({link}): {commands}. Version: {}. Machine: {}. Date: {}.",
            join("version"),
            join("machine"),
            join("date")
        );
        if self.is_trial() {
            foot += " A trial.";
        }
        if self.head("note").next().is_some() {
            foot += &format!(" {}.", join("note"));
        }
        foot
    }

    /// Whether the program does not repeat it.
    pub fn is_trial(&self) -> bool {
        self.head("trial").next().is_some()
    }

    /// Keeps the rows of which a `column=value` is true.
    pub fn keep(&mut self, condition: &str) -> Result<(), String> {
        let (name, value) = condition
            .split_once('=')
            .ok_or("where needs column=value")?;
        let place = self.places(&[name])?[0];
        self.rows.retain(|row| row[place] == value);
        match self.rows.is_empty() {
            true => Err(format!("no row with {condition}")),
            false => Ok(()),
        }
    }

    fn places(&self, names: &[&str]) -> Result<Vec<usize>, String> {
        let place = |name: &&str| {
            let found = self.names.iter().position(|own| own == name);
            found.ok_or_else(|| format!("no column `{name}`"))
        };
        names.iter().map(place).collect()
    }

    /// Places and units of columns that are given as `name` or `name unit`.
    fn cells<'a>(&self, orders: &[&'a str]) -> Result<Vec<(usize, &'a str)>, String> {
        let cell = |order: &&'a str| {
            let split = match self.names.iter().any(|name| name == order) {
                true => (*order, ""),
                false => order.rsplit_once(' ').unwrap_or((order, "")),
            };
            Ok((self.places(&[split.0])?[0], split.1))
        };
        orders.iter().map(cell).collect()
    }

    /// All columns, or these.
    pub fn plain(&self, orders: &[&str]) -> Result<String, String> {
        let cells = match orders.is_empty() {
            true => (0..self.names.len()).map(|k| (k, "")).collect(),
            false => self.cells(orders)?,
        };
        let head = |(k, unit): &(usize, &str)| match scaled(&self.names[*k], unit) {
            Some((si, _)) => self.names[*k].replace(si, &format!("({unit})")),
            None => self.names[*k].clone(),
        };
        let heads: Vec<String> = cells.iter().map(head).collect();
        let own = |row: &Vec<String>| {
            let one = |cell: &(usize, &str)| match scaled(&self.names[cell.0], cell.1) {
                Some((_, scale)) => significant(&row[cell.0], scale),
                None => value(row, cell),
            };
            cells.iter().map(one).collect()
        };
        let rows: Vec<Vec<String>> = self.rows.iter().map(own).collect();
        Ok(markdown(&heads, &rows))
    }

    /// One row for each value of `rows`, one column for each value of `columns`.
    pub fn crossed(
        &self,
        rows: &[&str],
        columns: &[&str],
        cells: &[&str],
    ) -> Result<String, String> {
        let (rows, columns) = (self.places(rows)?, self.places(columns)?);
        let cells = self.cells(cells)?;
        let keys = |places: &[usize]| {
            let mut keys: Vec<String> = Vec::new();
            for row in &self.rows {
                if !keys.contains(&key(row, places)) {
                    keys.push(key(row, places));
                }
            }
            keys
        };
        let heads = keys(&columns);
        let line = |name: &String| {
            let cell = |head: &String| {
                let is_own =
                    |row: &&Vec<String>| key(row, &rows) == *name && key(row, &columns) == *head;
                let own: Vec<&Vec<String>> = self.rows.iter().filter(is_own).collect();
                self.summary(&own, &cells)
            };
            [name.clone()]
                .into_iter()
                .chain(heads.iter().map(cell))
                .collect()
        };
        let grid: Vec<Vec<String>> = keys(&rows).iter().map(line).collect();
        let heads: Vec<String> = [String::new()].into_iter().chain(heads.clone()).collect();
        Ok(markdown(&heads, &grid))
    }

    /// One cell of several rows: their values, or with the unit `all` whether they all are true.
    fn summary(&self, rows: &[&Vec<String>], cells: &[(usize, &str)]) -> String {
        if rows.is_empty() {
            return "-".to_string();
        }
        if let [(place, "all")] = cells {
            let is_true = |row: &&Vec<String>| row[*place] == "true";
            let word = if rows.iter().all(is_true) {
                "kept"
            } else {
                "known"
            };
            return word.to_string();
        }
        let status = self.names.iter().position(|name| name == "status");
        let shown = |row: &&Vec<String>| match status.map_or("done", |place| &row[place]) {
            "done" => values(row, cells),
            other => other.to_string(),
        };
        rows.iter().map(shown).collect::<Vec<_>>().join("; ")
    }
}

/// Values of some columns, as a label.
fn key(row: &[String], places: &[usize]) -> String {
    let parts: Vec<&str> = places.iter().map(|k| row[*k].as_str()).collect();
    short(&parts.join(", "))
}

fn values(row: &[String], cells: &[(usize, &str)]) -> String {
    let values: Vec<String> = cells.iter().map(|cell| value(row, cell)).collect();
    values.join(", ")
}

/// A cell as it stands, or, where a unit is given, as a rounded number.
fn value(row: &[String], (place, unit): &(usize, &str)) -> String {
    match row[*place].parse::<f64>() {
        Ok(value) if !unit.is_empty() => rounded(value, unit),
        _ => short(&row[*place]),
    }
}

/// The SI unit in the name of a column, and what makes its values those of another unit.
fn scaled(name: &str, unit: &str) -> Option<(&'static str, f64)> {
    let known = [
        ("(m)", "mm", 1e3),
        ("(s)", "ms", 1e3),
        ("(J)", "uJ", 1e6),
        ("(kg)", "mg", 1e6),
    ];
    let mut known = known.into_iter();
    let (si, _, scale) = known.find(|(si, other, _)| *other == unit && name.ends_with(si))?;
    Some((si, scale))
}

/// A number times `scale` to three digits; a text as it stands.
fn significant(text: &str, scale: f64) -> String {
    let Ok(value) = text.parse::<f64>() else {
        return text.to_string();
    };
    let value = scale * value;
    let digits = match value.abs() {
        size if size < 9.995 => 2,
        size if size < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.digits$}")
}

/// A label whose decimal numbers have at most four digits behind the point.
fn short(label: &str) -> String {
    let word = |word: &str| match (word.split_once('.'), word.parse::<f64>()) {
        (Some((_, digits)), Ok(value)) if digits.len() > 6 => format!("{value:.4}"),
        _ => word.to_string(),
    };
    label.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A number to two or three digits, with its unit; a ratio as percentage.
pub fn rounded(value: f64, unit: &str) -> String {
    if unit == "sci" {
        return format!("{value:.3e}");
    }
    let value = if unit == "%" { 100.0 * value } else { value };
    let digits = match value.abs() {
        size if size >= 1000.0 && unit == "%" => return "> 1,000 %".to_string(),
        size if size < 0.0995 => 3,
        size if size < 0.995 => 2,
        _ if unit == "deg" => 1,
        size if size < 9.95 || unit == "%" && size < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.digits$} {unit}").trim_end().to_string()
}

fn markdown(heads: &[String], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = format!("|{}\n", "---|".repeat(heads.len()));
    let body: String = rows.iter().map(|row| line(row)).collect();
    line(heads) + &rule + &body
}

#[test]
fn units_are_scaled() {
    let text = "# version: 3\n# machine: A\n# date: today\n\
                run,deepest (m),when (s)\na,0.008971,0.0239\nb,,\n";
    let table = Table::parse(text).unwrap();
    assert_eq!(
        table
            .plain(&["run", "deepest (m) mm", "when (s) ms"])
            .unwrap(),
        "| run | deepest (mm) | when (ms) |\n|---|---|---|\n| a | 8.97 | 23.9 |\n| b |  |  |\n"
    );
}

#[test]
fn tables_are_rendered() {
    let text = "# version: 3\n# machine: A\n# date: today\n\
                spacing,method,status,error\n\
                1 mm,a,done,0.0526\n2 mm,a,done,0.0071\n1 mm,b,diverged,\n";
    let table = Table::parse(text).unwrap();
    let crossed = table
        .crossed(&["method"], &["spacing"], &["error %"])
        .unwrap();
    let expected =
        "|  | 1 mm | 2 mm |\n|---|---|---|\n| a | 5.3 % | 0.71 % |\n| b | diverged | - |\n";
    assert_eq!(crossed, expected);
    assert_eq!(
        table.plain(&["method"]).unwrap().lines().nth(2),
        Some("| a |")
    );
    assert!(table.plain(&["colour"]).is_err());
    let mut part = Table::parse(text).unwrap();
    assert!(part.keep("method=c").is_err());
    let mut part = Table::parse(text).unwrap();
    part.keep("method=a").unwrap();
    assert_eq!(part.rows.len(), 2);
    let promises = "# a: b\ncase,by,kept\nx,m,true\nx,m,false\ny,m,true\n";
    let promises = Table::parse(promises).unwrap();
    let kept = promises.crossed(&["case"], &["by"], &["kept all"]);
    assert_eq!(kept.unwrap().lines().last(), Some("| y | kept |"));
    assert!(
        table
            .foot("data/x.csv")
            .contains("command not recorded. Version: 3. Machine: A.")
    );
    assert!(Table::parse("# version 3\na\n1\n").is_err());
}

#[test]
fn numbers_are_rounded() {
    assert_eq!(rounded(0.7265, "%"), "72.7 %");
    assert_eq!(rounded(368.2, "%"), "> 1,000 %");
    assert_eq!(rounded(0.0543, "s"), "0.054 s");
    assert_eq!(rounded(407.4, "s"), "407 s");
    assert_eq!(rounded(119.96, "deg"), "120.0 deg");
    assert_eq!(rounded(-9.869e-6, "sci"), "-9.869e-6");
    assert_eq!(short("0.333333333333 mm, d/12"), "0.3333 mm, d/12");
}
