//! The first touch of a triangle and of something that moves along a line without turning, in double precision and
//! closed form. Both are apart at the start.
//!
//! Two triangles first touch at a corner of one and the face of the other, or at an edge of each. A triangle and a
//! segment with a radius first touch where the line meets one of the pieces of their Minkowski difference: faces moved
//! outwards by the radius, cylinders about edges, and spheres about corners.

use glam::DVec3;

/// Tolerance in barycentric coordinates and along edges, so that nothing slips through an edge.
const SLACK: f64 = 1.0e-9;

/// Sine of the angle between line and face below which the line is in the plane of the face, squared.
const IN_PLANE: f64 = 1.0e-24;

/// Rounding of a distance along the line, relative to the size of the triangles.
const ROUNDING: f64 = 1.0e-12;

/// Touches whose distances differ by less, relative to the size of the triangles, happen at the same time.
const TIE: f64 = 1.0e-9;

/// A first touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Distance along the line, not negative.
    pub distance: f64,
    /// Point on the triangle that rests.
    pub point: DVec3,
    /// Unit vector against the motion, normal to the features that touch.
    pub normal: DVec3,
    /// Whether one of the features is a face.
    is_face: bool,
    /// Distances that count as the same.
    tie: f64,
}

/// The first of several touches, with what the caller told of it.
pub struct First<T> {
    way: DVec3,
    found: Option<(Touch, T)>,
}

impl<T> First<T> {
    /// No touch so far. All touches will be of something that moves along the unit vector `way`.
    pub fn new(way: DVec3) -> Self {
        Self { way, found: None }
    }

    /// Adds a touch. Among touches at the same time one of a face comes first, then the one with the normal most
    /// directly against the motion. The distance is always the shortest.
    pub fn add(&mut self, touch: Touch, of: T) {
        let Some((first, _)) = &mut self.found else {
            self.found = Some((touch, of));
            return;
        };
        let distance = touch.distance.min(first.distance);
        let rank = |touch: &Touch| (touch.is_face, -touch.normal.dot(self.way));
        let is_before = if (touch.distance - first.distance).abs() > touch.tie.max(first.tie) {
            touch.distance < first.distance
        } else {
            rank(&touch) > rank(first)
        };
        first.distance = distance;
        if is_before {
            self.found = Some((Touch { distance, ..touch }, of));
        }
    }

    /// The distance beyond which touches are of no interest.
    pub fn most(&self) -> f64 {
        let latest = self.found.as_ref().map(|(touch, _)| touch.distance + touch.tie);
        latest.unwrap_or(f64::INFINITY)
    }

    /// The first touch.
    pub fn found(self) -> Option<(Touch, T)> {
        self.found
    }
}

/// Distance and barycentric coordinates at which the line from the origin along `way` meets a triangle; `None` also for
/// a line in its plane. The distance is in units of the length of `way`, and may be negative.
pub fn line_meets(way: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let slope = way.dot(normal);
    if slope * slope <= IN_PLANE * way.length_squared() * normal.length_squared() {
        return None;
    }
    let moment = a.cross(way);
    let (v, w) = (moment.dot(ac) / slope, -moment.dot(ab) / slope);
    let inside = v >= -SLACK && w >= -SLACK && v + w <= 1.0 + SLACK;
    inside.then(|| (a.dot(normal) / slope, [1.0 - v - w, v, w]))
}

/// The first touch of triangle `a` and triangle `b`, which moves along the unit vector `way`. Triangles in one plane
/// that move along it do not touch.
pub fn triangles(a: &[DVec3; 3], b: &[DVec3; 3], way: DVec3) -> Option<Touch> {
    let mut first = Pieces::new(way, a, b);
    let [face_a, face_b] = [a, b].map(|t| against(way, (t[1] - t[0]).cross(t[2] - t[0])));
    for k in 0..3 {
        if let Some((distance, _)) = line_meets(way, a.map(|q| q - b[k])) {
            first.add(distance, b[k] + way * distance, face_a, true);
        }
        if let Some((distance, _)) = line_meets(-way, b.map(|p| p - a[k])) {
            first.add(distance, a[k], face_b, true);
        }
        for j in 0..3 {
            first.add_edges([b[k], b[(k + 1) % 3]], [a[j], a[(j + 1) % 3]], 0.0);
        }
    }
    first.touches.found().map(|(touch, ())| touch)
}

/// The first touch of a triangle and of the points within `radius` of a segment that moves along the unit vector `way`.
/// The ends of the segment may be equal.
pub fn round(triangle: &[DVec3; 3], ends: [DVec3; 2], radius: f64, way: DVec3) -> Option<Touch> {
    let mut first = Pieces::new(way, triangle, &ends);
    let [p, q] = ends;
    let is_point = p == q;
    let ends = if is_point { &ends[..1] } else { &ends[..] };
    let [a, b, c] = *triangle;
    let face = against(way, (b - a).cross(c - a));
    for &end in ends {
        if let Some((distance, _)) = line_meets(way, triangle.map(|corner| corner + face * radius - end)) {
            first.add(distance, end + way * distance - face * radius, face, true);
        }
    }
    for k in 0..3 {
        let (corner, next) = (triangle[k], triangle[(k + 1) % 3]);
        for &end in ends {
            first.add_sphere(end, corner, radius);
            first.add_cylinder(end, [corner, next], radius);
        }
        if !is_point {
            first.add_edges([p, q], [corner, next], radius);
            first.add_corner(corner, [p, q], radius);
        }
    }
    first.touches.found().map(|(touch, ())| touch)
}

/// The unit vector of a normal that points against `way`.
fn against(way: DVec3, normal: DVec3) -> DVec3 {
    let unit = normal.normalize_or_zero();
    if unit.dot(way) > 0.0 { -unit } else { unit }
}

/// The touches of the pieces of a pair.
struct Pieces {
    way: DVec3,
    size: f64,
    touches: First<()>,
}

impl Pieces {
    fn new(way: DVec3, resting: &[DVec3; 3], moving: &[DVec3]) -> Self {
        let [a, b, c] = *resting;
        let edges = a.distance(b).max(a.distance(c));
        Self {
            way,
            size: moving.iter().map(|p| p.distance(a)).fold(edges, f64::max),
            touches: First::new(way),
        }
    }

    fn add(&mut self, distance: f64, point: DVec3, normal: DVec3, is_face: bool) {
        // The two were apart at the start: an earlier touch is rounding.
        if distance.is_nan() || distance < -ROUNDING * self.size {
            return;
        }
        let touch = Touch {
            distance: distance.max(0.0),
            point,
            normal,
            is_face,
            tie: TIE * self.size,
        };
        self.touches.add(touch, ());
    }

    /// Adds the touch of the moving edge `e` and the resting edge `f`, if they touch between their ends.
    fn add_edges(&mut self, [e, e_end]: [DVec3; 2], [f, f_end]: [DVec3; 2], radius: f64) {
        let way = self.way;
        let (u, v) = (e_end - e, f_end - f);
        let area = u.cross(v);
        let slope = way.dot(area);
        if slope * slope <= IN_PLANE * area.length_squared() {
            return;
        }
        let normal = against(way, area);
        // e + s u + distance way = f + radius normal + t v
        let apart = f + normal * radius - e;
        let (s, t) = (apart.dot(v.cross(way)) / slope, apart.dot(u.cross(way)) / slope);
        let range = -SLACK..=1.0 + SLACK;
        if range.contains(&s) && range.contains(&t) {
            self.add(apart.dot(area) / slope, f + v * t, normal, false);
        }
    }

    /// Adds the touch of the moving point `end` and the sphere about a corner.
    fn add_sphere(&mut self, end: DVec3, corner: DVec3, radius: f64) {
        if let Some((distance, normal)) = enters(end - corner, self.way, radius) {
            self.add(distance, corner, normal, false);
        }
    }

    /// Adds the touch of the moving point `end` and the cylinder about an edge.
    fn add_cylinder(&mut self, end: DVec3, [from, to]: [DVec3; 2], radius: f64) {
        if let Some((distance, normal, along)) = enters_cylinder(end - from, to - from, self.way, radius) {
            self.add(distance, from + (to - from) * along, normal, false);
        }
    }

    /// Adds the touch of a corner and the cylinder about the moving segment.
    fn add_corner(&mut self, corner: DVec3, [from, to]: [DVec3; 2], radius: f64) {
        if let Some((distance, normal, _)) = enters_cylinder(corner - from, to - from, -self.way, radius) {
            self.add(distance, corner, -normal, false);
        }
    }
}

/// The distance at which the line from `start` along `way` enters the sphere about the origin, and the normal there.
fn enters(start: DVec3, way: DVec3, radius: f64) -> Option<(f64, DVec3)> {
    let squared = way.length_squared();
    // By the nearest point of the line. The usual quadratic formula would lose digits on long ways.
    let nearest = -start.dot(way) / squared;
    let gap = (start + way * nearest).length();
    if gap > radius {
        return None;
    }
    let distance = nearest - ((radius - gap) * (radius + gap) / squared).sqrt();
    let normal = (start + way * distance).normalize_or(-way.normalize());
    Some((distance, normal))
}

/// The distance at which the line enters the cylinder about the segment from the origin to `axis`, the normal there,
/// and the position along the axis as a fraction of it.
fn enters_cylinder(start: DVec3, axis: DVec3, way: DVec3, radius: f64) -> Option<(f64, DVec3, f64)> {
    let squared = axis.length_squared();
    let across = |v: DVec3| v - axis * (v.dot(axis) / squared);
    let across_way = across(way);
    // Along the axis only the spheres at its ends are met. An axis of no length gives NaN.
    if across_way.length_squared().is_nan() || across_way.length_squared() <= IN_PLANE {
        return None;
    }
    let (distance, normal) = enters(across(start), across_way, radius)?;
    let along = (start + way * distance).dot(axis) / squared;
    (-SLACK..=1.0 + SLACK)
        .contains(&along)
        .then_some((distance, normal, along))
}
