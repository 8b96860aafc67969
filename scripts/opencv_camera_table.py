"""Writes OpenCV's own projections of seeded random points: the table that the camera models are tested against.

    python3 scripts/opencv_camera_table.py crates/core/tests/data/opencv_camera.csv

Needs opencv-python and numpy. The same versions of both write the same file.
"""

import sys

import cv2
import numpy as np

POINTS_PER_CAMERA = 100

# Name, model, [fx, fy, cx, cy], distortion, largest angle of the points from the optical axis in degrees.
# cv2.fisheye.projectPoints divides by z: its points stay in front of the camera, below 90°.
CAMERAS = [
    ("walk", "OPENCV_FISHEYE", [214.906223, 214.906223, 319.5, 239.5],
     [-0.058061286, 0.008174184, -0.000916262, 0.000047755], 88.0),
    ("mild fisheye", "OPENCV_FISHEYE", [330.2442, 328.9, 292.1307, 401.3261], [-0.03325321, 0.0010053, 0.0, 0.0], 85.0),
    ("growing fisheye", "OPENCV_FISHEYE", [150.0, 150.0, 320.0, 240.0], [0.05, 0.01, -0.002, 0.0001], 80.0),
    ("pinhole", "PINHOLE", [600.0, 610.0, 320.0, 240.0], [], 60.0),
    ("webcam", "OPENCV", [618.5678, 620.1, 309.193, 264.7764], [0.0164092, 0.0, 0.0, 0.0, 0.0], 40.0),
    ("strong barrel", "OPENCV", [420.0, 420.0, 319.5, 239.5], [-0.32, 0.11, 0.0, 0.0, -0.015], 35.0),
    ("tangential", "OPENCV", [500.0, 505.0, 330.0, 250.0], [-0.28, 0.07, 0.0015, -0.0021, 0.002], 35.0),
]


def points(generator, max_angle_deg):
    """Points in the camera's axes, uniform in angle, 0.2 to 10 m away; the first lies on the optical axis."""
    angle = np.radians(generator.uniform(0.0, max_angle_deg, POINTS_PER_CAMERA))
    angle[0] = 0.0
    around = generator.uniform(0.0, 2.0 * np.pi, POINTS_PER_CAMERA)
    distance = generator.uniform(0.2, 10.0, POINTS_PER_CAMERA)
    unit = np.stack([np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)], axis=1)
    return unit * distance[:, None]


def project(model, intrinsics, distortion, objects):
    """Pixels as OpenCV computes them."""
    fx, fy, cx, cy = intrinsics
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    objects, zero = objects.reshape(-1, 1, 3), np.zeros(3)
    if model == "OPENCV_FISHEYE":
        pixels, _ = cv2.fisheye.projectPoints(objects, zero, zero, matrix, np.array(distortion))
    else:
        pixels, _ = cv2.projectPoints(objects, zero, zero, matrix, np.array(distortion or [0.0] * 4))
    return pixels.reshape(-1, 2)


def main(path):
    """One row a point; a camera's parameters are repeated in each of its rows."""
    generator = np.random.default_rng(2013)
    with open(path, "w", encoding="utf-8", newline="\n") as table:
        table.write("# python3 scripts/opencv_camera_table.py crates/core/tests/data/opencv_camera.csv\n")
        table.write(f"# OpenCV {cv2.__version__}, NumPy {np.__version__}; points in metres, camera axes; pixels.\n")
        table.write("camera,model,fx,fy,cx,cy,d1,d2,d3,d4,d5,x_m,y_m,z_m,u_px,v_px\n")
        for name, model, intrinsics, distortion, max_angle_deg in CAMERAS:
            objects = points(generator, max_angle_deg)
            parameters = intrinsics + distortion + [0.0] * (5 - len(distortion))
            for point, pixel in zip(objects, project(model, intrinsics, distortion, objects)):
                row = [repr(float(value)) for value in [*parameters, *point, *pixel]]
                table.write(",".join([name, model, *row]) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
