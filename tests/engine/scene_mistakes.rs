//! All mistakes of a scene file in one run.

use crate::scene_error::holds;
use coronet::scene::error::SceneError;
use coronet::scene::file;
use std::path::Path;

#[test]
fn all_mistakes_of_a_file_are_told_at_once() {
    let text = "
dimension = 2
[box]
size = ['12 mm', '9 kg']
x = 'periodic'
[liquid]
densty = '1000 kg/m^3'
[effects.gravity]
acceleration = '-9.81 m/s^2'
[body.pool]
layer = { depth = '3 mm' }
[body.drop]
disc = { diameter = '2.4 mm', gap = '0.5 mm', above = 'pol' }
velocity = ['1 m/s', '1 m/s', '1 m/s', '1 m/s']
[method]
name = 'wcph'
[pack]
spacing = '0.3 mm'
[impact]
[frames]
interval = '0.5 ms'
";
    let mistakes = file::read(text, Path::new("seven.toml"), &[]).unwrap_err();
    let SceneError::Many(all) = &mistakes else {
        panic!("{mistakes}");
    };
    let wanted = [
        ["seven.toml:4:18", "box.size[1]", "mm"],
        [
            "seven.toml:7:1",
            "liquid.densty",
            "did you mean `liquid.density`?",
        ],
        ["seven.toml:9:16", "effects.gravity.acceleration", "must be"],
        ["seven.toml:13:", "body.drop.disc.above", "pool"],
        ["seven.toml:14:", "body.drop.velocity", "give"],
        ["seven.toml:16:8", "method.name", "did you mean \"wcsph\"?"],
        ["seven.toml:19:", "impact.end", "Write end"],
    ];
    assert_eq!(all.len(), wanted.len(), "{mistakes}");
    for (mistake, parts) in all.iter().zip(&wanted) {
        holds(&mistake.to_string(), parts);
    }
    holds(&mistakes.to_string(), &["7 mistakes:\n  seven.toml:4:18"]);
}
