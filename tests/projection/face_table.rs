//! The file form of the face table: what is written is read, and nothing that is made up does harm.

use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::faces::TableError;
use bevy_faceoff::projection::{BakeSettings, FaceTable, Progress, bake_pool};
use proptest::prelude::*;
use std::sync::OnceLock;

const BITS: u64 = 0;
const LIST: u64 = 1;
const DIFFERENCE: u64 = 2;
const KNOWN: u64 = 3;

fn settings(degrees: u32) -> BakeSettings {
    BakeSettings {
        faces: true,
        degrees,
        image: 64,
        ..BakeSettings::default()
    }
}

fn torus_table() -> &'static (FaceTable, Vec<u8>) {
    static TABLE: OnceLock<(FaceTable, Vec<u8>)> = OnceLock::new();
    TABLE.get_or_init(|| {
        let table = FaceTable::bake(&shapes::torus_240(), &settings(30), bake_pool(), &Progress::default());
        let table = table.expect("nobody cancels");
        let bytes = table.encode();
        (table, bytes)
    })
}

fn number(mut n: u64, out: &mut Vec<u8>) {
    while n >= 0x80 {
        out.push(n as u8 | 0x80);
        n >>= 7;
    }
    out.push(n as u8);
}

/// Bytes of numbers, as the format has them.
fn numbers(list: &[u64]) -> Vec<u8> {
    let mut out = Vec::new();
    list.iter().for_each(|&n| number(n, &mut out));
    out
}

/// A table by hand: a header and then runs, each a head and its content.
fn by_hand(triangles: u32, degrees: u32, groups: u64, memory: u64, runs: &[Vec<u8>]) -> Vec<u8> {
    let mut out = numbers(&[u64::from(triangles), u64::from(degrees), groups, memory]);
    runs.iter().for_each(|run| out.extend(run));
    out
}

/// 100 triangles, 6 directions, every way a run can be written, and groups of both stored forms.
fn small_runs() -> Vec<Vec<u8>> {
    let mut bits = vec![0xff; 13];
    bits[12] = 0x0f;
    vec![
        numbers(&[LIST, 2, 7, 90]),        // 7 and 98, kept as a list
        numbers(&[DIFFERENCE, 2, 7, 1]),   // without 7, with 9
        [numbers(&[BITS]), bits].concat(), // all 100, kept as bits
        numbers(&[DIFFERENCE, 1, 99]),     // all but the last
        numbers(&[KNOWN, 3]),              // the first again
        numbers(&[DIFFERENCE, 0]),         // and once more, as if it were new
    ]
}

const SMALL_MEMORY: u64 = 2 + 2 + 13 + 13 + 2;

#[test]
fn every_way_of_writing_is_read() {
    let bytes = by_hand(100, 90, 5, SMALL_MEMORY, &small_runs());
    let table = FaceTable::decode(&bytes, 100, &settings(90)).unwrap();
    let group = |direction| table.of_direction(direction).iter().collect::<Vec<u32>>();
    assert_eq!(group(0), [7, 98]);
    assert_eq!(group(1), [9, 98]);
    assert_eq!(group(2), Vec::from_iter(0..100));
    assert_eq!(group(3), Vec::from_iter(0..99));
    assert_eq!(group(4), [7, 98]);
    assert_eq!(group(5), [7, 98]);
    assert_eq!(table.directions(), [0, 1, 2, 3, 0, 4]);
    let again = FaceTable::decode(&table.encode(), 100, &settings(90)).unwrap();
    assert_eq!(again, table);
    // By way of differences from list to bits and back.
    let runs = [
        [vec![LIST as u8], numbers(&[1, 50])].concat(),
        [vec![DIFFERENCE as u8, 20], vec![0; 20]].concat(), // 0..20 and 50
        [vec![DIFFERENCE as u8, 20], vec![0; 20]].concat(), // 50
        numbers(&[2 * 4 + KNOWN, 1]),
    ];
    let table = FaceTable::decode(&by_hand(100, 90, 3, 1 + 13 + 1, &runs), 100, &settings(90)).unwrap();
    let group = |direction| table.of_direction(direction).iter().collect::<Vec<u32>>();
    assert_eq!((group(0), group(2)), (vec![50], vec![50]));
    assert_eq!(group(1), Vec::from_iter((0..20).chain([50])));
    assert_eq!(group(5), group(1));
}

#[test]
fn announced_sizes_must_be_right() {
    let read = |groups, memory| FaceTable::decode(&by_hand(100, 90, groups, memory, &small_runs()), 100, &settings(90));
    assert!(read(5, SMALL_MEMORY).is_ok());
    for groups in [0, 1, 4, 6, 7, 1 << 20, u64::from(u32::MAX) + 6, u64::MAX >> 1] {
        assert!(read(groups, SMALL_MEMORY).is_err(), "{groups} groups");
    }
    for memory in [
        0,
        1,
        SMALL_MEMORY - 1,
        SMALL_MEMORY + 1,
        1 << 20,
        1 << 30,
        u64::MAX >> 1,
    ] {
        assert!(read(5, memory).is_err(), "{memory} bytes");
    }
    for triangles in [0, 8, 99, 101, u32::MAX] {
        let bytes = by_hand(triangles, 90, 5, SMALL_MEMORY, &small_runs());
        assert!(FaceTable::decode(&bytes, 100, &settings(90)).is_err());
    }
    assert!(FaceTable::decode(&by_hand(100, 90, 5, SMALL_MEMORY, &small_runs()), 100, &settings(45)).is_err());
}

#[test]
fn impossible_runs_are_refused() {
    let bits = |last: u8| [vec![(5 * 4 + BITS) as u8], vec![0; 12], vec![last]].concat();
    let read = |memory, run: Vec<u8>| FaceTable::decode(&by_hand(100, 90, 1, memory, &[run]), 100, &settings(90));
    assert!(read(1, bits(0x08)).is_ok());
    for (what, run) in [
        ("a bit beyond the last triangle", bits(0x10)),
        ("an index beyond it", numbers(&[5 * 4 + LIST, 1, 100])),
        ("one by way of gaps", numbers(&[5 * 4 + LIST, 2, 98, 1])),
        ("one by way of a difference", numbers(&[5 * 4 + DIFFERENCE, 1, 100])),
        (
            "an index that does not fit 32 bits",
            numbers(&[5 * 4 + LIST, 1, 1 << 32]),
        ),
        ("the largest number", numbers(&[5 * 4 + LIST, 2, 1, u64::MAX >> 1])),
        (
            "a longer number",
            [numbers(&[5 * 4 + LIST, 1]), vec![0xff; 10]].concat(),
        ),
        ("a group that is not there yet", numbers(&[5 * 4 + KNOWN, 0])),
        ("too many directions", numbers(&[6 * 4 + LIST, 1, 5])),
        ("too few directions", numbers(&[4 * 4 + LIST, 1, 5])),
        ("a list longer than the bytes", numbers(&[5 * 4 + LIST, 1 << 40, 5])),
        ("bytes left over", numbers(&[5 * 4 + LIST, 1, 5, 0])),
    ] {
        assert!(matches!(read(1, run), Err(TableError::Damaged(_))), "{what}");
    }
    // The group before the first one is empty, and a run may name none from the future.
    assert!(read(1, numbers(&[5 * 4 + DIFFERENCE, 1, 99])).is_ok());
    let runs = [numbers(&[LIST, 1, 5]), numbers(&[4 * 4 + KNOWN, 1])];
    assert!(FaceTable::decode(&by_hand(100, 90, 1, 1, &runs), 100, &settings(90)).is_err());
}

#[test]
fn truncated_tables_are_refused() {
    let (table, bytes) = torus_table();
    assert_eq!(FaceTable::decode(bytes, 240, &settings(30)).as_ref(), Ok(table));
    for len in 0..bytes.len() {
        assert!(FaceTable::decode(&bytes[..len], 240, &settings(30)).is_err());
    }
    let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
    assert!(FaceTable::decode(&longer, 240, &settings(30)).is_err());
}

#[test]
fn few_bytes_describe_little_memory() {
    // Many triangles and one of them visible, then nothing changes in any other direction: small, though not honest.
    let runs: Vec<Vec<u8>> = std::iter::once(numbers(&[LIST, 1, 0]))
        .chain((1..64_442).map(|_| numbers(&[DIFFERENCE, 0])))
        .collect();
    let bytes = by_hand(u32::MAX, 1, 64_442, 4 * 64_442, &runs);
    assert!(FaceTable::decode(&bytes, u32::MAX, &settings(1)).is_ok());

    // Such runs with a group of 64 KiB stand for 4 GiB.
    let triangles: u32 = 1 << 19;
    let all = [numbers(&[BITS]), vec![0xff; 1 << 16]].concat();
    let runs: Vec<Vec<u8>> = std::iter::once(all.clone())
        .chain((1..64_442).map(|_| numbers(&[DIFFERENCE, 0])))
        .collect();
    let bytes = by_hand(triangles, 1, 64_442, 64_442 << 16, &runs);
    assert_eq!(
        FaceTable::decode(&bytes, triangles, &settings(1)),
        Err(TableError::Damaged("it claims more memory than its length allows"))
    );
    // Told as if it were less, it is refused where the lie shows.
    let bytes = by_hand(triangles, 1, 64_442, 1 << 20, &runs);
    assert!(FaceTable::decode(&bytes, triangles, &settings(1)).is_err());
    // Naming the group costs nothing.
    let runs: Vec<Vec<u8>> = std::iter::once(all)
        .chain((1..64_442).map(|_| numbers(&[KNOWN, 0])))
        .collect();
    let bytes = by_hand(triangles, 1, 1, 1 << 16, &runs);
    let table = FaceTable::decode(&bytes, triangles, &settings(1)).unwrap();
    assert!(table.memory_bytes() < 1 << 19);
    assert_eq!(table.at(17, 200).len(), 1 << 19);
}

/// The writer has to keep within what the reader believes: differences first, and bits where they would describe too much.
#[test]
fn large_groups_that_hardly_differ_are_written_so_that_they_are_read() {
    let triangles: u32 = 1 << 17;
    let all = [numbers(&[BITS]), vec![0xff; 1 << 14]].concat();
    // 265 of 266 directions in turn lose a triangle; the differences come first, and long groups afterwards pay for them.
    let differences = 180;
    let runs: Vec<Vec<u8>> = std::iter::once(all.clone())
        .chain((0..differences).map(|t| numbers(&[DIFFERENCE, 1, t])))
        .chain((0..265 - differences).map(|i| {
            let mut run = all.clone();
            run[1 + i as usize] = 0x55;
            run
        }))
        .collect();
    let bytes = by_hand(triangles, 15, 266, 266 << 14, &runs);
    let table = FaceTable::decode(&bytes, triangles, &settings(15)).unwrap();
    let encoded = table.encode();
    assert_eq!(FaceTable::decode(&encoded, triangles, &settings(15)), Ok(table));
    // 266 groups of 16 KiB are 4.2 MiB: at 64 bytes each, less one MiB, that takes 50 KiB at least.
    assert!(
        encoded.len() > 50 << 10 && encoded.len() < bytes.len() / 2,
        "{}",
        encoded.len()
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn damaged_tables_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let (_, bytes) = torus_table();
        let mut bytes = bytes.clone();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= value;
        }
        if let Ok(table) = FaceTable::decode(&bytes, 240, &settings(30)) {
            // Whatever was accepted is a table of this mesh.
            prop_assert!((0..12).all(|a| (0..12).all(|b| table.at(a, b).iter().all(|t| t < 240))));
            prop_assert_eq!(FaceTable::decode(&table.encode(), 240, &settings(30)), Ok(table));
        }
    }

    #[test]
    fn random_bytes_never_panic(
        tail in prop::collection::vec(any::<u8>(), 0..400),
        triangles in any::<u32>(),
        groups in 0..8_u64,
        memory in 0..1000_u64,
    ) {
        let bytes = by_hand(triangles, 90, groups, memory, &[tail]);
        let _ = FaceTable::decode(&bytes, triangles, &settings(90));
    }
}
