//! A layer without smooth edges: a pixel shows it or does not.

use reality_sim::simulator::{Canvas, Fragment, Layer, Object, PARTS, Sphere, View};

/// Layer whose pixels are covered wholly, where it covers half of them, or not at all.
#[derive(Debug)]
pub struct HardEdges<'a> {
    pub layer: &'a dyn Layer,
}

impl Layer for HardEdges<'_> {
    fn objects(&self) -> Vec<Object<'_>> {
        self.layer.objects()
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        let mut smooth = Canvas::new(view.size());
        self.layer.draw(view, &mut smooth);
        let area = smooth.area();
        canvas.open(area);
        for (v, u) in (area.top..area.bottom).flat_map(|v| (area.left..area.right).map(move |u| (v, u))) {
            let covered = smooth.fragments(u, v).fold(0, |parts, fragment| parts | fragment.parts);
            let nearest = smooth.fragments(u, v).min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
            if let Some(nearest) = nearest.filter(|_| 2 * covered.count_ones() as usize >= PARTS) {
                canvas.put(u, v, Fragment { parts: Fragment::ALL, ..*nearest });
            }
        }
    }

    fn occluders(&self) -> Vec<Sphere> {
        self.layer.occluders()
    }
}
