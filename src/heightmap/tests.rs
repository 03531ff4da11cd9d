//! Files of every format, made here, and what is left of them when they are damaged.
#![allow(clippy::unwrap_used)]

use std::io::Write;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::*;

const COUNTS: [usize; 2] = [5, 3];

/// What every file of these tests has: whole numbers, so that each type of number holds them.
fn height(i: usize, j: usize) -> f64 {
    (100 * i + 7 * j * j) as f64 - 50.0
}

fn heights() -> Vec<f64> {
    (0..15).map(|k| height(k / 3, k % 3)).collect()
}

/// In the order of files that have x fastest.
fn x_fastest() -> Vec<f64> {
    (0..15).map(|k| height(k % 5, k / 5)).collect()
}

fn npy(kind: &str, fortran: bool, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': (5, 3), }}\n");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

fn floats() -> Vec<u8> {
    npy("<f8", false, &heights().iter().flat_map(|h| h.to_le_bytes()).collect::<Vec<_>>())
}

fn sdf_header(compression: u8, data_type: u8) -> Vec<u8> {
    let mut bytes = b"bISO-1.0mpjr tests010120260000010120260000".to_vec();
    bytes.extend([5_u16, 3].iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend([0.5_f64, 0.25, 2.0, -1.0].iter().flat_map(|scale| scale.to_le_bytes()));
    bytes.extend([compression, data_type, 0]);
    bytes
}

/// 16-bit integers.
fn sdf() -> Vec<u8> {
    let data = x_fastest().into_iter().flat_map(|h| (h as i16).to_le_bytes());
    sdf_header(0, 5).into_iter().chain(data).collect()
}

fn sdf_text(first: &str) -> Vec<u8> {
    let mut text =
        "aISO-1.0\nManufacID = tests\nNumPoints = 5\nNumProfiles = 3\nXscale = 0.5\nYscale = 0.25\nZscale = 2\n\
                    Zresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n"
            .to_owned();
    let words: Vec<String> = x_fastest().iter().map(|h| format!("{h}")).collect();
    text += &words.join(" ").replacen("-50", first, 1);
    (text + "\n*\n").into_bytes()
}

/// The index of an archive of heights z = 2 (raw/2 + 0).
fn x3p_index(more: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\"><Record1><Revision>ISO5436 - 2000\
         </Revision><FeatureType>SUR</FeatureType><Axes><CX><AxisType>I</AxisType><Increment>0.5</Increment></CX><CY><AxisType>I\
         </AxisType><Increment>0.25</Increment></CY><CZ><AxisType>A</AxisType><DataType>L</DataType><Increment>2</Increment>\
         <Offset>0</Offset></CZ></Axes></Record1><Record3><MatrixDimension><SizeX>5</SizeX><SizeY>3</SizeY><SizeZ>1</SizeZ>\
         </MatrixDimension><DataLink><PointDataLink>bindata/data.bin</PointDataLink>{more}</DataLink></Record3></p:ISO5436_2>"
    )
}

fn archive(members: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in members {
        writer.start_file(*name, SimpleFileOptions::default()).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn x3p(valid: Option<[u8; 2]>) -> Vec<u8> {
    let data: Vec<u8> = x_fastest().into_iter().flat_map(|h| (h as i32).to_le_bytes()).collect();
    let link = if valid.is_some() { "<ValidPointsLink>bindata/valid.bin</ValidPointsLink>" } else { "" };
    let index = x3p_index(link);
    let valid = valid.unwrap_or_default();
    archive(&[("main.xml", index.as_bytes()), ("bindata/data.bin", &data), ("bindata/valid.bin", &valid)])
}

fn matrix() -> Vec<u8> {
    let line = |i: usize| format!("{:.1}\t{:.1}\t{:.1}\n", height(i, 0), height(i, 1), height(i, 2));
    (0..5).map(line).collect::<String>().into_bytes()
}

fn points() -> Vec<u8> {
    // From the last to the first.
    let line =
        |k: usize| format!("{} {} {}\n", 1.0 + 0.5 * (k / 3) as f64, 0.25 * (k % 3) as f64 - 2.0, height(k / 3, k % 3));
    (0..15).rev().map(line).collect::<String>().into_bytes()
}

fn all() -> Vec<(Format, Vec<u8>)> {
    vec![
        (Format::Npy, floats()),
        (Format::Matrix, matrix()),
        (Format::Points, points()),
        (Format::Sdf, sdf()),
        (Format::Sdf, sdf_text("-50")),
        (Format::X3p, x3p(None)),
    ]
}

/// The same point has the same height in each format; where they say them, spacing and origin.
#[test]
fn every_format_has_the_same_heights() {
    for (format, bytes) in all() {
        let read = format.parse(&bytes, [None; 2]).unwrap();
        // What instruments store has a scale of 2.
        let scale = if format.is_in_metres() { 2.0 } else { 1.0 };
        let expected: Vec<f64> = heights().iter().map(|h| scale * h).collect();
        assert_eq!((read.counts, &read.values), (COUNTS, &expected), "{format:?}");
        let spacing = format.has_spacing().then_some([0.5, 0.25]);
        assert_eq!(read.spacing, spacing, "{format:?}");
        assert_eq!(read.origin, (format == Format::Points).then_some([1.0, -2.0]), "{format:?}");
    }
    let micrometres = Format::Matrix.parse(&matrix(), [None, Unit::parse("um")]).unwrap();
    assert_eq!((micrometres.values[4], micrometres.note().as_str()), (57.0 / 1e6, "in um"));
    let titled =
        [b"x (mm),y (mm),z (um)\n".to_vec(), points().iter().map(|b| if *b == b' ' { b',' } else { *b }).collect()]
            .concat();
    let titled = Format::Points.parse(&titled, [None; 2]).unwrap();
    assert_eq!((titled.spacing, titled.note().as_str()), (Some([0.5e-3, 0.25e-3]), "x and y in mm, z in um"));
}

/// Numbers of every type that NumPy writes, in both orders of bytes and of indices.
#[test]
fn arrays_of_every_type() {
    macro_rules! check {
        ($($type:ty, $kind:literal);*) => {$(
            for (mark, fortran) in [("<", false), (">", true), ("<", true)] {
                let numbers = if fortran { x_fastest() } else { heights() };
                // Unsigned numbers and short ones hold what is left of these.
                let numbers: Vec<$type> = numbers.iter().map(|h| (h.abs() % 100.0) as $type).collect();
                let bytes = |n: &$type| if mark == ">" { n.to_be_bytes().to_vec() } else { n.to_le_bytes().to_vec() };
                let data: Vec<u8> = numbers.iter().flat_map(bytes).collect();
                let read = Format::Npy.parse(&npy(&format!("{mark}{}", $kind), fortran, &data), [None; 2]).unwrap();
                assert_eq!(read.values, heights().iter().map(|h| h.abs() % 100.0).collect::<Vec<_>>(), "{mark}{}", $kind);
            }
        )*};
    }
    check!(f64, "f8"; f32, "f4"; i8, "i1"; i16, "i2"; i32, "i4"; i64, "i8"; u8, "u1"; u16, "u2"; u32, "u4"; u64, "u8");
    let negative = npy("|i1", false, &[0xff; 15]);
    assert_eq!(Format::Npy.parse(&negative, [None; 2]).unwrap().values, [-1.0; 15]);
}

#[test]
fn what_is_wrong_is_said() {
    let nan = npy(
        "<f8",
        false,
        &heights()
            .iter()
            .map(|h| if *h > 300.0 { f64::NAN } else { *h })
            .flat_map(f64::to_le_bytes)
            .collect::<Vec<_>>(),
    );
    let none = "has 3 points of 15 without a value, the first at [4, 0]";
    let short = &floats()[..150];
    let hole: Vec<u8> = points()[..points().len() - 10].to_vec();
    let invalid = {
        let mut bytes = sdf();
        let end = bytes.len();
        bytes[end - 2..].copy_from_slice(&i16::MIN.to_le_bytes());
        bytes
    };
    let cases: [(Format, Vec<u8>, &str); 17] = [
        (Format::Npy, nan, none),
        (Format::Npy, short.to_vec(), "says that it has 5 x 3 points of 8 bytes, but has "),
        (Format::Npy, b"PK".to_vec(), "is no .npy file"),
        (Format::Npy, npy("<c16", false, &[0; 240]), "must hold real numbers of 1 to 8 bytes, but its type is '<c16'"),
        (
            Format::Npy,
            String::from_utf8_lossy(&npy("|i1", false, &[1; 15])).replace("(5, 3)", "(15,) ").into_bytes(),
            "is no .npy file",
        ),
        (Format::Matrix, b"1 2\n3 nan\n5 6\n".to_vec(), "has 1 points of 6 without a value, the first at [1, 1]"),
        (Format::Matrix, b"1 2 3\n4 5 6\n7 8\n".to_vec(), "line 3: 2 columns, but most lines have 3"),
        (Format::Points, hole, "has 1 points of 15 without a value"),
        (Format::Points, b"0 0 1\n0 1 2\n1 0 3\n1 1 4\n0.7 0 5\n".to_vec(), "is no regular grid: x = "),
        (
            Format::Points,
            b"0 0 1\n1 1 2\n2 2 3\n3 3 3\n4 4 3\n5 5 1\n".to_vec(),
            "is no grid: its 6 points have 6 different x and 6 different y",
        ),
        (Format::Points, b"0 0 1\n0 1 2\n1 0 3\n1 1 4\n1 1 5\n".to_vec(), "has two points at x = 1.0, y = 1.0 m"),
        (Format::Sdf, invalid, "has 1 points of 15 without a value, the first at [4, 2]"),
        (Format::Sdf, sdf_text("BAD"), "has 1 points of 15 without a value, the first at [0, 0]"),
        (Format::Sdf, sdf_text("1 2"), "says that it has 5 x 3 points, but has 16 heights"),
        (Format::Sdf, [sdf_header(1, 5), vec![0; 30]].concat(), "is compressed"),
        (Format::X3p, x3p(Some([0b1111_1101, 0xff])), "has 1 points of 15 without a value, the first at [1, 0]"),
        (Format::X3p, archive(&[("main.xml", x3p_index("").as_bytes())]), "has no `bindata/data.bin` that can be read"),
    ];
    for (format, bytes, expected) in cases {
        let message = format.parse(&bytes, [None; 2]).unwrap_err();
        assert!(message.starts_with(expected), "{format:?}: {message}");
    }
    assert!(Format::of("surface.png").unwrap_err().starts_with("must be the name of a file that ends in .npy, .h5"));
}

/// Files that declare far more than they have are refused before anything is allocated for it.
#[test]
fn sizes_that_are_not_there() {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }";
    let huge = [b"\x93NUMPY\x02\x00", &(header.len() as u32).to_le_bytes()[..], header.as_bytes(), &[0; 64]].concat();
    let text = String::from_utf8(sdf_text("1")).unwrap().replace("NumPoints = 5", "NumPoints = 999999999");
    let index = x3p_index("").replace("<SizeX>5<", "<SizeX>18446744073709551615<");
    let zip = archive(&[("main.xml", index.as_bytes()), ("bindata/data.bin", &[0; 60])]);
    let longer = archive(&[("main.xml", x3p_index("").as_bytes()), ("bindata/data.bin", &vec![0; 1 << 22])]);
    let deep = archive(&[("main.xml", "<a>".repeat(100_000).as_bytes())]);
    for (format, bytes) in [
        (Format::Npy, huge),
        (Format::Sdf, text.into_bytes()),
        (Format::X3p, zip),
        (Format::X3p, longer),
        (Format::X3p, deep),
    ] {
        assert!(format.parse(&bytes, [None; 2]).is_err());
    }
}

/// Truncated at every byte, and with bits turned over by a generator of numbers: an answer, whatever it is.
#[test]
fn damaged_files_are_survived() {
    let mut state = 1_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for (format, bytes) in all() {
        for length in 0..bytes.len() {
            // What is cut off a text or an archive may be nothing that counts.
            refused += usize::from(format.parse(&bytes[..length], [None; 2]).is_err());
        }
        for _ in 0..3000 {
            let mut damaged = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(damaged.len());
                damaged[at] ^= 1 << random(8);
            }
            refused += usize::from(format.parse(&damaged, [None; 2]).is_err());
        }
    }
    assert!(refused > 5000, "{refused}");
}

/// A plane is taken off whole, and nothing else.
#[test]
fn a_tilt_is_taken_off() {
    let bump = |i: f64, j: f64| (i - 2.0).powi(2) * (j - 1.0).powi(2);
    let values = (0..15).map(|k| [(k / 3) as f64, (k % 3) as f64]).map(|[i, j]| 3.0 + 0.2 * i - 0.7 * j + bump(i, j));
    let mut heights = Heights::bare(COUNTS, values.collect());
    heights.take_off_plane();
    // The mean of the bump is 2 times 2/3.
    for (k, value) in heights.values.iter().enumerate() {
        assert!((value - bump((k / 3) as f64, (k % 3) as f64) + 4.0 / 3.0).abs() < 1e-14);
    }
    let numbers = heights.clone().into_numbers([0.5, 0.25], [1.0, 2.0]);
    let again = Heights::from_numbers(&numbers).unwrap();
    assert_eq!((again.values, again.spacing, again.origin), (heights.values, Some([0.5, 0.25]), Some([1.0, 2.0])));
    assert!(Heights::from_numbers(&numbers[1..]).is_none() && Heights::from_numbers(&[]).is_none());
}
