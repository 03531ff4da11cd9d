//! Files of every kind that instruments write, made here.
#![allow(clippy::unwrap_used)]

use super::*;

/// All columns of a text: the values by row, and how many points were skipped.
fn read(bytes: &[u8]) -> Result<(Vec<Vec<f64>>, usize), Fault> {
    let table = Table::read(bytes)?;
    let all: Vec<usize> = (0..table.width()).collect();
    let columns = table.columns(&all)?;
    Ok((columns.rows.into_iter().map(|row| row.values).collect(), columns.skipped))
}

/// The same three rows, whatever separates them.
#[test]
fn separators_and_decimal_commas() {
    let expected = vec![vec![0.5, 5.0], vec![1.0, -4.25], vec![10.0, 3e2]];
    for text in [
        "0.5,5\n1,-4.25\n10,3e2\n",
        "0.5;5\n1;-4.25\n10;300\n",
        "0,5;5\n1;-4,25\n10;3E2",
        "0,5;5,0;\n1,0;-4,25;\n10,0;3E2;",
        "0.5\t5\r\n1\t-4.25\r\n10\t3D+2\r\n",
        "0,5\t5\n1\t\u{2212}4,25\n10\t3,0e+2\n",
        "  0.5   5\n 1 \t -4.25\n10 300 # the last\n",
        "0,5 5,0\n1,0 -4,25\n10,0 300\n",
        ".5 5\n1, -4.25\n10 ,300\n",
        "\"0.5\",\"5\"\n\"1\",\"-4.25\"\n\"10\",\"300\"\n",
        "\"0,5\",\"5\"\n\"1\",\"-4,25\"\n\"10\",\"300\"\n",
        "\u{feff}0.5 5\n\n# between\n1 -4.25\n  \n10 300\n\n",
        "0.5 5\r1 -4.25\r10 300\r",
    ] {
        let (rows, skipped) = read(text.as_bytes()).unwrap();
        let two: Vec<Vec<f64>> = rows.iter().map(|row| row[..2].to_vec()).collect();
        // A separator at the end of every line makes a third column, which is empty.
        let empty = text.contains(";\n1");
        assert!((two == expected && skipped == 0) || empty, "{text:?}: {rows:?}");
        if empty {
            let table = Table::read(text.as_bytes()).unwrap();
            assert_eq!(table.columns(&[0, 1]).unwrap().rows.len(), 3);
        }
    }
}

#[test]
fn encodings() {
    let text = "Zeit (s);Kraft (µm)\r\n0,5;5\r\n1;-4,25\r\n";
    let utf16 = |bytes: fn(u16) -> [u8; 2], mark: &str| -> Vec<u8> {
        (mark.to_owned() + text).encode_utf16().flat_map(bytes).collect()
    };
    let latin: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
    for bytes in [
        text.as_bytes().to_vec(),
        ("\u{feff}".to_owned() + text).into_bytes(),
        utf16(u16::to_le_bytes, "\u{feff}"),
        utf16(u16::to_be_bytes, "\u{feff}"),
        utf16(u16::to_le_bytes, ""),
        utf16(u16::to_be_bytes, ""),
        latin,
    ] {
        assert_eq!(read(&bytes).unwrap(), (vec![vec![0.5, 5.0], vec![1.0, -4.25]], 0));
        assert_eq!(Table::read(&bytes).unwrap().unit(1).unwrap().name, "um");
    }
    assert_eq!(read(b"1 2\n3\0 4\n").unwrap_err().line, 2);
}

/// Names and units of two columns, wherever they stand; metadata before them count for nothing.
#[test]
fn titles_and_units() {
    for text in [
        "t, G\ns, MPa\n0.1,5\n1,4\n",
        "t (s),G [MPa]\n0.1,5\n1,4\n",
        "t_(s);G_(MPa)\n0.1;5\n1;4\n",
        "# t in s, G in MPa\n0.1 5\n1 4\n",
        "# t (s) G (MPa)\n0.1 5\n1 4\n",
        "t (s) G (MPa)\n0.1 5\n1 4\n",
        "t\tG\n[s]\t[MPa]\n0.1\t5\n1\t4\n",
        "Rheometer 7\nSample;EVA\nTemperature;25,0\nt;G\ns;MPa\n0,1;5\n1;4\n",
        "t/s\tG/MPa\n0.1\t5\n1\t4\n",
        "\"t, s\";\"G, MPa\"\n0.1;5\n1;4\n",
    ] {
        let table = Table::read(text.as_bytes()).unwrap();
        assert_eq!((table.width(), table.title(0), table.title(1)), (2, "t", "G"), "{text:?}");
        let units: Vec<_> = [0, 1].map(|column| table.unit(column).map(|unit| unit.name)).into();
        assert_eq!(units, [Some("s"), Some("MPa")], "{text:?}");
        assert_eq!(table.columns(&[0, 1]).unwrap().rows.len(), 2, "{text:?}");
        assert_eq!(table.find(&"g".parse().unwrap()), Ok(1));
    }
    let table = Table::read(b"a,b\n1,2\n").unwrap();
    assert_eq!(table.find(&"c".parse().unwrap()).unwrap_err(), "there is no column `c`; it has 2 columns: `a`, `b`");
    assert_eq!(table.find(&"3".parse().unwrap()).unwrap_err(), "there is no column 3; it has 2 columns: `a`, `b`");
    assert_eq!((table.unit(0), table.title(1)), (None, "b"));
    let long = Table::read(format!("{},b\n1,2\n", "x".repeat(100_000)).as_bytes()).unwrap();
    assert!(long.find(&Choice::Title("y".repeat(100_000))).unwrap_err().len() < 200);
}

/// Rows in any order, other columns of words, titles again between two blocks.
#[test]
fn chosen_columns() {
    let text = "date;f;T;E\n2026-01-02;100;25,5;3\n2026-01-03;10;n/a;2\n\ndate;f;T;E\n2026-01-03;1;25;1\nend of data\n";
    let table = Table::read(text.as_bytes()).unwrap();
    let mut columns = table.columns(&[1, 3]).unwrap();
    assert_eq!(columns.skipped, 0);
    assert!(columns.sort() && !columns.sort());
    let rows: Vec<(usize, &[f64])> = columns.rows.iter().map(|row| (row.line, row.values.as_slice())).collect();
    assert_eq!(rows, [(6, &[1.0, 1.0][..]), (3, &[10.0, 2.0]), (2, &[100.0, 3.0])]);
    assert_eq!(table.columns(&[1, 2]).unwrap().skipped, 1);
}

#[test]
fn points_without_a_value_are_counted() {
    let text = "x,z\n0,***\n1,Bad\n2,NaN\n3,---\n4,\n5,#N/A\n,\n6,1\n7,2\n8,no data\n";
    assert_eq!(read(text.as_bytes()).unwrap(), (vec![vec![6.0, 1.0], vec![7.0, 2.0]], 8));
    assert_eq!(read(b"0\t1\n1\t\n2\t3\n").unwrap(), (vec![vec![0.0, 1.0], vec![2.0, 3.0]], 1));
}

#[test]
fn what_is_wrong_has_its_line() {
    for (text, line, reason) in [
        ("", 1, "the file ends here without any line of two numbers"),
        ("t,G\n# nothing\n", 2, "the file ends here without any line of two numbers"),
        ("1\n2\n3\n", 1, "`1` is not two numbers; give at least two columns"),
        ("t,G\n1,2\n3\n", 3, "1 column, but most lines have 2"),
        ("1,2\n2,1\n3,1,1\n", 3, "3 columns, but most lines have 2"),
        ("1,2\n2,1,1\n3,1,1\n", 1, "2 columns, but most lines have 3; begin comments with #"),
        ("t,G\n1,2\n2,abc\n3,4\n", 3, "`abc` is not a number"),
        ("1,abc\n2,3\n3,4\n", 1, "`abc` is not a number; begin comments with #"),
        ("0.1.2,5\n2,3\n3,4\n", 1, "`0.1.2` is not a number; begin comments with #"),
        ("1,2\n2,inf\n3,4\n", 2, "`inf` is not a number"),
        ("1,2\n2,1e999\n", 2, "`1e999` is not a finite number"),
        (
            "x z\n0 1\n1 \u{7}\u{7}\u{7}abcdefghijklmnopqrstuvwxyz0123456789\n2 2\n",
            3,
            "`???abcdefghijklmnopqrstuvwxyz0...` is not a number",
        ),
    ] {
        let fault = read(text.as_bytes()).unwrap_err();
        assert_eq!((fault.line, fault.reason.as_str()), (line, reason), "{text:?}");
    }
}

#[test]
fn units_keep_the_digits() {
    let micron = Unit::parse("µm").unwrap();
    assert_eq!((micron.to_si(0.3), Unit::parse("Microns").unwrap()), (3e-7, micron));
    assert_eq!(Unit::parse("GPa").unwrap().to_si(2.5), 2.5e9);
    // Milli- or mega-: not said.
    assert_eq!(Unit::parse("mpa"), None);
    assert_eq!(Unit::names(Quantity::Frequency), ["Hz", "kHz"]);
}
