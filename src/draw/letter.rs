//! Lettering of the pictures: strokes of the needed letters, for any size, without a font file.
//!
//! A glyph is a list of strokes, a stroke a list of points of two base-36 digits, x then y. The
//! base line is y = 4, small letters end at y = b, capitals at y = e, tails at y = 0. A stroke that
//! starts with `~` is a smooth curve through the middles of its polygon.

const GLYPHS: &[(char, &str)] = &[
    ('0', "~4e8e84040e4e"),
    ('1', "1b4e44"),
    ('2', "~0b0e8e8a04 0484"),
    ('3', "~0c0e8e8949 ~4999940407"),
    ('4', "646e0787"),
    ('5', "7e1e1a ~1a3b9b940406"),
    ('6', "~4a8a84040a4a ~070e5e7d"),
    ('7', "0e8e34"),
    ('8', "~4e7e79191e4e ~498984040949"),
    ('9', "~4e8e88080e4e ~8b843415"),
    ('.', "1415"),
    (',', "1502"),
    ('-', "0969"),
    ('+', "0969 3c36"),
    ('=', "0b7b 0777"),
    ('/', "026e"),
    ('(', "~3f0c0632"),
    (')', "~0f3c3602"),
    ('a', "~3b6b64040b3b 6b64"),
    ('c', "~6a6b0b046465"),
    ('d', "~3b6b64040b3b 6e64"),
    ('e', "0868 ~686b0b046465"),
    ('h', "0e04 ~080b6b68 6864"),
    ('i', "0b04 0e0d"),
    ('k', "0e04 076b 2864"),
    ('l', "0e04"),
    ('m', "0b04 ~080b4b48 4844 ~484b8b88 8884"),
    ('n', "0b04 ~080b6b68 6864"),
    ('o', "~3b6b64040b3b"),
    ('p', "0b00 ~3b6b64040b3b"),
    ('r', "0b04 ~080b4b5a"),
    ('s', "~6a6b0b0868640405"),
    ('t', "2e26 ~262454 0b5b"),
    ('u', "0b07 ~07046467 6b64"),
    ('v', "0b346b"),
    ('x', "0b64 046b"),
    ('y', "0b34 6b10"),
    ('z', "0b6b0464"),
    ('J', "~6e660406"),
    ('P', "040e 0e4e ~4e8e8949 4909"),
];

/// Whether there are strokes for the letter.
pub fn known(letter: char) -> bool {
    letter == ' ' || GLYPHS.iter().any(|(c, _)| *c == letter)
}

/// Strokes of a letter, base line at zero, capitals 10 high; and its advance.
pub fn strokes(letter: char) -> (Vec<Vec<[f32; 2]>>, f32) {
    let Some((_, code)) = GLYPHS.iter().find(|(c, _)| *c == letter) else {
        return (Vec::new(), 6.0);
    };
    let strokes: Vec<Vec<[f32; 2]>> = code.split(' ').map(stroke).collect();
    let right = strokes.iter().flatten().map(|p| p[0]).fold(0.0, f32::max);
    (strokes, right + 3.2)
}

/// Length of a text in the units of [`strokes`].
pub fn length(text: &str) -> f32 {
    text.chars()
        .map(|c| strokes(c).1)
        .fold(0.0, |sum, a| sum + a)
}

fn stroke(code: &str) -> Vec<[f32; 2]> {
    let digits: Vec<f32> = code
        .chars()
        .filter_map(|c| c.to_digit(36))
        .map(|d| d as f32)
        .collect();
    let points: Vec<[f32; 2]> = digits.chunks_exact(2).map(|p| [p[0], p[1] - 4.0]).collect();
    if code.starts_with('~') {
        (0..3).fold(points, |line, _| cut_corners(&line))
    } else {
        points
    }
}

/// One round of Chaikin's corner cutting with fixed ends.
fn cut_corners(line: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut cut = vec![line[0]];
    for pair in line.windows(2) {
        for part in [0.25, 0.75] {
            cut.push([0, 1].map(|i| pair[0][i] + part * (pair[1][i] - pair[0][i])));
        }
    }
    cut.push(line[line.len() - 1]);
    cut
}
