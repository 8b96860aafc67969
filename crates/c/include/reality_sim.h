/*
 * Recorded pictures for simulators: what does the camera see at this pose?
 *
 * Metres, radians and seconds everywhere. The world has its origin at the field's centre, x towards the opponent's goal, y left and z
 * up. Pictures lie in memory row by row from the top, without gaps.
 *
 * Every function that can fail returns a status. Where it is not RS_STATUS_OK, rs_message() tells what was wrong and what to do; nothing
 * that was given to the function has changed, but for what is in buffers. Different threads may use different cameras at once.
 *
 * Made by cbindgen from crates/c/src: do not edit.
 */

#ifndef REALITY_SIM_H
#define REALITY_SIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * Outcome of a function.
 */
typedef enum RsStatus {
  /**
   * It did what was asked.
   */
  RS_STATUS_OK = 0,
  /**
   * An argument was missing or impossible.
   */
  RS_STATUS_ARGUMENT = 1,
  /**
   * The database could not be read.
   */
  RS_STATUS_DATABASE = 2,
  /**
   * Too little was recorded near the pose for a picture.
   */
  RS_STATUS_NO_PICTURE = 3,
  /**
   * The library failed where it must not. Its authors would like to hear of it.
   */
  RS_STATUS_DEFECT = 4,
} RsStatus;

/**
 * Class of a pixel or of a thing.
 */
typedef enum RsClass {
  /**
   * Neither field nor object: the hall, its floor beside the carpet, and what the lens leaves black.
   */
  RS_CLASS_OUTSIDE = 0,
  /**
   * Carpet without a line.
   */
  RS_CLASS_CARPET = 1,
  /**
   * White line or mark.
   */
  RS_CLASS_LINE = 2,
  /**
   * Post, crossbar or net of a goal.
   */
  RS_CLASS_GOAL = 3,
  /**
   * Ball.
   */
  RS_CLASS_BALL = 4,
  /**
   * Robot.
   */
  RS_CLASS_ROBOT = 5,
} RsClass;

/**
 * Camera that a simulator moves over a recorded field.
 */
typedef struct RsCamera RsCamera;

/**
 * How pictures are made.
 */
typedef struct RsOptions {
  /**
   * Memory for decoded pictures, bytes.
   */
  size_t cache_bytes;
  /**
   * Number of recorded pictures that are mixed, 1 to 8.
   */
  size_t neighbours;
  /**
   * Whether the camera gives labels.
   */
  bool labels;
  /**
   * Whether people, robots and balls that stood there while recording are left out.
   */
  bool clean;
  /**
   * Whether there is a picture however far away the nearest recorded one is.
   */
  bool best_effort;
} RsOptions;

/**
 * Pose of a camera in the world.
 */
typedef struct RsPose {
  /**
   * Place, metres.
   */
  double x_m;
  /**
   * Place, metres.
   */
  double y_m;
  /**
   * Heading, radians, counterclockwise from the x axis.
   */
  double yaw_rad;
  /**
   * Height above the ground, metres.
   */
  double height_m;
  /**
   * Pitch, radians, positive downwards.
   */
  double pitch_rad;
  /**
   * Roll, radians, positive clockwise as seen from behind the camera.
   */
  double roll_rad;
} RsPose;

/**
 * Ball of one colour.
 */
typedef struct RsBall {
  /**
   * Centre, metres.
   */
  double x_m;
  /**
   * Centre, metres.
   */
  double y_m;
  /**
   * Centre, metres: the radius where the ball lies on the ground.
   */
  double z_m;
  /**
   * Radius, metres.
   */
  double radius_m;
  /**
   * Velocity in the world, metres per second, by which the picture is blurred.
   */
  double velocity_m_s[3];
  /**
   * Colour in white light: red, green and blue, sRGB.
   */
  uint8_t color[3];
} RsBall;

/**
 * Robot of simple parts.
 */
typedef struct RsRobot {
  /**
   * Place between its feet, metres.
   */
  double x_m;
  /**
   * Place between its feet, metres.
   */
  double y_m;
  /**
   * Heading, radians.
   */
  double yaw_rad;
  /**
   * Height, metres.
   */
  double height_m;
  /**
   * Phase of its gait, radians. It stands where this is not a number.
   */
  double gait_rad;
  /**
   * Velocity in the world, metres per second, by which the picture is blurred.
   */
  double velocity_m_s[2];
  /**
   * Colour of its team in white light: red, green and blue, sRGB.
   */
  uint8_t color[3];
} RsRobot;

/**
 * Everything that is drawn over the recorded scene.
 */
typedef struct RsScene {
  /**
   * Balls; not read where there are none.
   */
  const struct RsBall *balls;
  /**
   * Number of balls.
   */
  size_t ball_count;
  /**
   * Robots; not read where there are none.
   */
  const struct RsRobot *robots;
  /**
   * Number of robots.
   */
  size_t robot_count;
} RsScene;

/**
 * Memory for what a camera sees, a value for every pixel. What is NULL is left out.
 */
typedef struct RsBuffers {
  /**
   * Picture: three bytes a pixel, red, green and blue, sRGB.
   */
  uint8_t *rgb;
  /**
   * Classes, see RsClass. This and what follows needs a camera with labels.
   */
  uint8_t *classes;
  /**
   * Thing that a pixel shows: 0 for none, 1 and 2 for the goals at -x and +x, then the balls and the robots in their order, from 3.
   */
  uint16_t *instances;
  /**
   * Distance along the pixel's ray, metres; infinite where the lens leaves the pixel black.
   */
  float *distance_m;
  /**
   * How far a pixel can be trusted, 0 to 255.
   */
  uint8_t *trust;
} RsBuffers;

/**
 * Ball or robot as the camera saw it.
 */
typedef struct RsSeenObject {
  /**
   * Class.
   */
  enum RsClass class_;
  /**
   * Whether a pixel shows it. The box is empty where none does.
   */
  bool is_visible;
  /**
   * First column of the pixels that show it.
   */
  uint32_t left;
  /**
   * First row.
   */
  uint32_t top;
  /**
   * Column after the last one.
   */
  uint32_t right;
  /**
   * Row after the last one.
   */
  uint32_t bottom;
  /**
   * Share of its pixels in the picture that show it, 0 to 1: what is left is behind something.
   */
  double visibility;
  /**
   * Share of it that lies outside the picture, 0 to 1.
   */
  double truncation;
} RsSeenObject;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the options that are usual: 1 GiB for pictures, six neighbours, labels.
 */
struct RsOptions rs_options(void);

/**
 * Opens a database, a file that `reality-sim build` makes, and makes a camera like the one that recorded it. It has to be closed by
 * rs_camera_close(). Without options (NULL) it has the usual ones.
 *
 * # Safety
 *
 * `path` is a text that ends with a zero, `options` NULL or valid, and `camera` can be written to.
 */
enum RsStatus rs_camera_open(const char *path,
                             const struct RsOptions *options,
                             struct RsCamera **camera);

/**
 * Closes a camera. NULL is no camera, and ignored.
 *
 * # Safety
 *
 * `camera` is NULL or of rs_camera_open(), and is not used afterwards.
 */
void rs_camera_close(struct RsCamera *camera);

/**
 * Tells the number of columns and rows of a camera's pictures.
 *
 * # Safety
 *
 * `camera` is of rs_camera_open(), and the others can be written to.
 */
enum RsStatus rs_camera_size(const struct RsCamera *camera, uint32_t *width, uint32_t *height);

/**
 * Tells the pose over the field's centre with the height, pitch and roll that most recorded pictures have.
 *
 * # Safety
 *
 * `camera` is of rs_camera_open(), and `pose` can be written to.
 */
enum RsStatus rs_camera_usual_pose(const struct RsCamera *camera, struct RsPose *pose);

/**
 * Draws what the camera sees: the recorded scene with balls and robots in it, through the true lens, and with the light and the shadows of
 * the hall. Without a scene (NULL) nothing is added. `time_s` decides the noise of what is added.
 *
 * # Safety
 *
 * `camera` is of rs_camera_open() and used by no other thread, `scene` is NULL or holds what it says, and what is not NULL in `buffers` has
 * room for a value, or three, for every pixel.
 */
enum RsStatus rs_camera_look(struct RsCamera *camera,
                             struct RsPose pose,
                             const struct RsScene *scene,
                             double time_s,
                             struct RsBuffers buffers);

/**
 * Tells how the last picture shows the balls and the robots, in this order. Writes as many as there is room for, and their whole number into
 * `count`.
 *
 * # Safety
 *
 * `camera` is of rs_camera_open(), there is room for `capacity` objects at `objects`, and `count` can be written to.
 */
enum RsStatus rs_camera_seen(const struct RsCamera *camera,
                             struct RsSeenObject *objects,
                             size_t capacity,
                             size_t *count);

/**
 * Tells at which pixel a camera at a pose sees a point in the world: column and row, whole numbers at the centres of pixels. It may be outside
 * the picture, or behind something. Fails where the lens sees no such direction.
 *
 * # Safety
 *
 * `camera` is of rs_camera_open(), three numbers are at `point_m`, and two can be written to `pixel`.
 */
enum RsStatus rs_camera_project(const struct RsCamera *camera,
                                struct RsPose pose,
                                const double *point_m,
                                double *pixel);

/**
 * Returns what the last function of this thread that failed could not do, and the remedy, in UTF-8; an empty text if none failed. It is valid
 * until the next one fails.
 */
const char *rs_message(void);

/**
 * Returns the version of the library.
 */
const char *rs_version(void);

/**
 * Returns an orange ball of FIFA's size 1 that lies on the ground.
 */
struct RsBall rs_ball(double x_m, double y_m);

/**
 * Returns a blue robot as tall as a NAO that stands.
 */
struct RsRobot rs_robot(double x_m, double y_m, double yaw_rad);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* REALITY_SIM_H */
