//! A robot as the simulator knows it, written as a URDF: what bags and viewers are given, whatever form its description has.

use super::Robot;
use crate::geometry::Outline;

impl Robot {
    /// Writes the robot as a URDF of two links: `base_link` on the floor below the body's reference point, and `laser`. The body is
    /// the cylinder, or the box around the polygon, that its outline and its heights give; no mesh, so that every viewer has all of it.
    pub fn as_urdf(&self) -> String {
        let [low, high] = self.body_z;
        let (height, middle) = ((high - low).max(0.01), f64::midpoint(low, high));
        let (shape, at) = match &self.footprint {
            Outline::Circle { center, radius } => {
                (format!("<cylinder radius=\"{radius}\" length=\"{height}\"/>"), *center)
            }
            Outline::Polygon(_) => {
                let bounds = self.footprint.bounds();
                let (length, width) = (bounds.width(), bounds.height());
                let shape = format!("<box size=\"{length} {width} {height}\"/>");
                (shape, (bounds.min + bounds.max) * 0.5)
            }
        };
        let origin = format!("<origin xyz=\"{} {} {middle}\" rpy=\"0 0 0\"/>", at.x, at.y);
        let part = |kind: &str, more: &str| {
            format!("    <{kind}>{origin}<geometry>{shape}</geometry>{more}</{kind}>\n")
        };
        let blue = "<material name=\"body\"><color rgba=\"0.34 0.71 0.91 1\"/></material>";
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<!-- Written by Reenact from what its simulator uses of the description in the bundle. -->\n\
             <robot name=\"{}\">\n  <link name=\"base_link\">\n",
            crate::figure::svg::escape(&self.name)
        );
        text.push_str(&part("visual", blue));
        text.push_str(&part("collision", ""));
        text.push_str("  </link>\n");
        if let Some(lidar) = &self.lidar {
            let mount = lidar.mount;
            text.push_str(&format!(
                "  <link name=\"laser\">\n    <visual><geometry><cylinder radius=\"0.03\" length=\"0.04\"/></geometry>\
                 <material name=\"laser\"><color rgba=\"0.1 0.1 0.1 1\"/></material></visual>\n  </link>\n\
                 \x20 <joint name=\"laser_joint\" type=\"fixed\">\n    <parent link=\"base_link\"/>\n    <child link=\"laser\"/>\n\
                 \x20   <origin xyz=\"{} {} {}\" rpy=\"0 0 {}\"/>\n  </joint>\n",
                mount.x, mount.y, lidar.height, mount.heading
            ));
        }
        text + "</robot>\n"
    }
}

#[cfg(test)]
mod tests {
    use crate::document::Source;
    use crate::geometry::Outline;

    /// Checks that what is written is read back as the robot that it was written from, as far as it says.
    #[test]
    fn robots_survive_the_round_trip() {
        for (name, text) in [
            ("kobuki", include_str!("../../robots/kobuki.urdf")),
            ("pioneer3at", include_str!("../../robots/pioneer3at.urdf")),
        ] {
            let (robot, _) = super::super::urdf::read(&Source::new(name, text)).unwrap();
            let urdf = robot.as_urdf();
            let document = roxmltree::Document::parse(&urdf).unwrap();
            let of = |tag: &str| document.descendants().find(|n| n.has_tag_name(tag)).unwrap();
            assert_eq!(document.root_element().attribute("name"), Some(robot.name.as_str()));
            let lidar = robot.lidar.as_ref().unwrap();
            let joint = of("joint").children().find(|n| n.has_tag_name("origin")).unwrap();
            let mount = lidar.mount;
            let xyz = format!("{} {} {}", mount.x, mount.y, lidar.height);
            assert_eq!(joint.attribute("xyz"), Some(xyz.as_str()), "{name}");
            match &robot.footprint {
                Outline::Circle { radius, .. } => {
                    assert_eq!(
                        of("cylinder").attribute("radius"),
                        Some(radius.to_string().as_str())
                    );
                }
                Outline::Polygon(_) => {
                    let size = of("box").attribute("size").unwrap();
                    let bounds = robot.footprint.bounds();
                    assert!(size.starts_with(&format!("{} {} ", bounds.width(), bounds.height())));
                }
            }
        }
    }
}
