/* A ball and a robot before a recorded field: writes the picture as PPM, and tells where they are in it.
 *
 *     ./camera walk.db picture.ppm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "reality_sim.h"

static int fail(const char *what)
{
    fprintf(stderr, "%s: %s\n", what, rs_message());
    return EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: %s DATABASE PICTURE.ppm\n", argv[0]);
        return EXIT_FAILURE;
    }
    RsCamera *camera = NULL;
    if (rs_camera_open(argv[1], NULL, &camera) != RS_STATUS_OK)
        return fail(argv[1]);

    uint32_t width, height;
    RsPose pose;
    if (rs_camera_size(camera, &width, &height) != RS_STATUS_OK || rs_camera_usual_pose(camera, &pose) != RS_STATUS_OK)
        return fail("camera");
    pose.x_m = -2.3;
    pose.y_m = 0.2;
    pose.yaw_rad = 1.6;

    const RsBall balls[] = { rs_ball(-2.5, 1.1) };
    const RsRobot robots[] = { rs_robot(-2.0, 1.7, -1.6) };
    const RsScene scene = { balls, 1, robots, 1 };
    uint8_t *rgb = malloc((size_t)3 * width * height);
    float *distance_m = malloc(sizeof(float) * width * height);
    const RsBuffers buffers = { .rgb = rgb, .distance_m = distance_m };
    if (rgb == NULL || distance_m == NULL)
        return EXIT_FAILURE;

    if (rs_camera_look(camera, pose, &scene, 0.0, buffers) != RS_STATUS_OK)
        return fail("look");

    RsSeenObject seen[2];
    size_t count;
    rs_camera_seen(camera, seen, 2, &count);
    for (size_t i = 0; i < count; i++)
        printf("%s: columns %u to %u, rows %u to %u, %.0f %% visible\n", seen[i].class_ == RS_CLASS_BALL ? "ball" : "robot",
               seen[i].left, seen[i].right, seen[i].top, seen[i].bottom, 100.0 * seen[i].visibility);

    const double center_m[3] = { balls[0].x_m, balls[0].y_m, balls[0].z_m };
    double pixel[2];
    if (rs_camera_project(camera, pose, center_m, pixel) != RS_STATUS_OK)
        return fail("centre of the ball");
    const long column = lround(pixel[0]), row = lround(pixel[1]);
    if (column >= 0 && column < (long)width && row >= 0 && row < (long)height)
        printf("centre of the ball: %.1f %.1f, %.2f m away\n", pixel[0], pixel[1], distance_m[(size_t)row * width + (size_t)column]);

    FILE *file = fopen(argv[2], "wb");
    if (file == NULL) {
        perror(argv[2]);
        return EXIT_FAILURE;
    }
    fprintf(file, "P6\n%u %u\n255\n", width, height);
    fwrite(rgb, 3, (size_t)width * height, file);
    fclose(file);

    /* What cannot be is told. */
    pose.x_m = NAN;
    if (rs_camera_look(camera, pose, NULL, 0.0, buffers) != RS_STATUS_ARGUMENT)
        return EXIT_FAILURE;
    printf("no pose: %s\n", rs_message());
    rs_camera_close(camera);
    free(distance_m);
    free(rgb);
    return EXIT_SUCCESS;
}
