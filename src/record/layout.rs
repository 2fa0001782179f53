//! A layout for Foxglove and Lichtblick. Both open a log with every topic hidden and with a camera
//! whose near plane is at half a metre; this layout shows all topics from a distance that suits the
//! box.

use serde_json::{Value, json};

/// What the layout shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Names of the bodies, as in the log.
    pub bodies: Vec<String>,
    /// Size of the box, m; y is zero in 2-D.
    pub size: [f64; 3],
    /// Whether the box is the half-plane beside an axis.
    pub is_axial: bool,
    /// Names of the figures of a frame, with unit suffix.
    pub figures: Vec<String>,
    /// Names of the scalars of a frame, likewise.
    pub scalars: Vec<String>,
}

const COLOURS: [&str; 6] = [
    "#4e98e2", "#f5774d", "#8bc34a", "#b06bd6", "#f7df71", "#5cd6a9",
];

impl Layout {
    /// Text of the layout file: the 3-D view at the left, a plot for each unit of the figures and
    /// of the scalars at the right.
    pub fn json(&self) -> String {
        let plots = self.plots();
        let mut panels = serde_json::Map::new();
        panels.insert("3D!coronet".into(), self.view());
        let mut column = Value::Null;
        for (index, (unit, paths)) in plots.iter().enumerate().rev() {
            let id = format!("Plot!{index}");
            panels.insert(id.clone(), plot(unit, paths));
            column = match column {
                Value::Null => json!(id),
                rest => json!({
                    "first": id,
                    "second": rest,
                    "direction": "column",
                    "splitPercentage": 100.0 / (plots.len() - index) as f64,
                }),
            };
        }
        let layout = match column {
            Value::Null => json!("3D!coronet"),
            column => json!({
                "first": "3D!coronet",
                "second": column,
                "direction": "row",
                "splitPercentage": 68,
            }),
        };
        let whole = json!({
            "configById": panels,
            "globalVariables": {},
            "userNodes": {},
            "playbackConfig": { "speed": 0.02 },
            "layout": layout,
        });
        format!("{whole:#}\n")
    }

    fn view(&self) -> Value {
        let mut topics = serde_json::Map::new();
        let shown = |size: u32| {
            json!({
                "visible": true,
                "colorMode": "rgba-fields",
                "pointShape": "circle",
                "pointSize": size,
            })
        };
        for body in &self.bodies {
            topics.insert(format!("/body/{body}"), shown(4));
        }
        let [x, y, z] = self.size;
        let is_section = y == 0.0 && !self.is_axial;
        let mut wall = shown(2);
        // The walls would hide the drop that falls towards them.
        wall["visible"] = json!(is_section);
        topics.insert("/wall".into(), wall);
        let (mut middle, mut width) = ([x / 2.0, y / 2.0], x.max(y));
        if self.is_axial {
            topics.insert("/revolved".into(), shown(3));
            (middle, width) = ([0.0; 2], 2.0 * x);
        }
        let distance = 1.8 * width.max(z);
        let (elevation, azimuth) = if is_section { (90, 0) } else { (68, 30) };
        json!({
            "cameraState": {
                "perspective": true,
                "distance": distance,
                "phi": elevation,
                "thetaOffset": azimuth,
                "targetOffset": [middle[0], middle[1], 0.4 * z],
                "target": [0, 0, 0],
                "targetOrientation": [0, 0, 0, 1],
                "fovy": 45,
                "near": distance / 1000.0,
                "far": distance * 1000.0,
            },
            "followMode": "follow-none",
            "followTf": "world",
            "scene": { "transforms": { "showLabel": false, "axisScale": 0 } },
            "transforms": {},
            "topics": topics,
            "layers": {},
            "publish": {},
            "imageMode": {},
        })
    }

    /// Unit and paths of the numbers of a topic that share it, in the order of first appearance.
    fn plots(&self) -> Vec<(String, Vec<String>)> {
        let mut plots = Vec::new();
        for (topic, names) in [("figures", &self.figures), ("measures", &self.scalars)] {
            let first = plots.len();
            for name in names {
                let path = format!("/{topic}.{name}");
                let unit = name.rsplit_once('_').map_or("", |(_, unit)| unit);
                let known: &mut Vec<(String, Vec<String>)> = &mut plots;
                match known[first..].iter_mut().find(|(known, _)| known == unit) {
                    Some((_, paths)) => paths.push(path),
                    None => known.push((unit.to_string(), vec![path])),
                }
            }
        }
        plots
    }
}

fn plot(unit: &str, paths: &[String]) -> Value {
    let path = |(index, path): (usize, &String)| {
        json!({
            "value": path,
            "label": path.rsplit('.').next(),
            "enabled": true,
            "timestampMethod": "receiveTime",
            "color": COLOURS[index % COLOURS.len()],
        })
    };
    let paths: Vec<_> = paths.iter().enumerate().map(path).collect();
    json!({
        "title": unit,
        "paths": paths,
        "showLegend": true,
        "legendDisplay": "top",
        "isSynced": true,
        "xAxisVal": "timestamp",
        "showXAxisLabels": true,
        "showYAxisLabels": true,
    })
}
