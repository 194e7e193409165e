#define_import_path faceoff::contours

// The segments of a pair, and the links between them.

#import faceoff::types as t

@group(0) @binding(2) var<storage, read> segments: array<t::Segment>;
// Links of segments, eight words each. A pair with n segments has: 4 n slots of a hash table of segment ends, by the
// crossing that an end shares with the next segment (then the list of loose ends; then n segments in the order of
// contours, n ends of contours in that order, and the first segments of contours); 2 n words, for each end its partner;
// n words, for each segment its label, the number of the first segment known to belong to the same contour; n words,
// for each first segment the number of segments in its contour.
@group(0) @binding(3) var<storage, read_write> contour_links: array<atomic<u32>>;

// A bit of a partner: the end is loose, and its partner is only near it.
const TIED: u32 = 0x80000000u;

// The pair's segments.
var<private> first: u32;
var<private> count: u32;

fn set_segments(start: u32, number: u32) {
    first = start;
    count = number;
}

fn slot(i: u32) -> u32 {
    return 8u * first + i;
}

fn partner_of(end: u32) -> u32 {
    return 8u * first + 4u * count + end;
}

fn label_of(i: u32) -> u32 {
    return 8u * first + 6u * count + i;
}

fn size_of(i: u32) -> u32 {
    return 8u * first + 7u * count + i;
}

// The i-th segment in the order of contours.
fn ordered(i: u32) -> u32 {
    return slot(i);
}

// Where the segments of a contour end in that order.
fn end_of(root: u32) -> u32 {
    return slot(count + root);
}

// The first segment of a contour that may have a patch.
fn root_of(contour: u32) -> u32 {
    return slot(2u * count + contour);
}

fn place(end: u32) -> vec3<f32> {
    let i = first + end / 2u;
    if end % 2u == 1u {
        return segments[i].end;
    }
    return segments[i].start;
}

// Whether no other end has the same crossing.
fn is_loose(end: u32) -> bool {
    return (atomicLoad(&contour_links[partner_of(end)]) & TIED) != 0u;
}
