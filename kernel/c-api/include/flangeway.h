/*
 * Flangeway: wheel-rail contact forces from a precomputed table, in bounded time.
 *
 * Written by cbindgen from src/ (see test.sh). C99 and C++. Track frame: x forward, y right, z down, origin on the
 * track's centre line at the plane of the rail crowns; SI units. Nothing here has state, allocates or locks: every
 * function may be called from any thread at any time, as long as no two of them write to the same place. A table, once
 * loaded, is only read, and its image must stay where it is. Functions return a flangeway_status as int32_t. NULL
 * and misaligned pointers, lengths and numbers are checked; that a pointer points to what it is declared to is up to
 * the caller.
 */

#ifndef FLANGEWAY_H
#define FLANGEWAY_H

#include <stddef.h>
#include <stdint.h>

// Version of this interface: grows when a struct or a function changes. Compare with `flangeway_interface_version()`.
#define FLANGEWAY_INTERFACE_VERSION 1

// Words of 8 bytes in a `flangeway_table`.
#define FLANGEWAY_TABLE_WORDS 512

// Slots of a wheel profile: the most contacts that a wheel can have.
#define FLANGEWAY_SLOTS 3

// What a function returns. Zero is success, everything else is an error; nothing is written then unless said.
enum flangeway_status
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    // Done.
    FLANGEWAY_STATUS_OK = 0,
    // A pointer is NULL.
    FLANGEWAY_STATUS_NULL = 1,
    // A pointer is not aligned for what it points to.
    FLANGEWAY_STATUS_MISALIGNED = 2,
    // A length times its element's size is beyond what memory can hold.
    FLANGEWAY_STATUS_LENGTH = 3,
    // The caller's room is too small: another header than this library's, or fewer places than results.
    FLANGEWAY_STATUS_SHORT_BUFFER = 4,
    // An input is NaN, infinite or beyond its limit. Outputs are written: zero force where it matters.
    FLANGEWAY_STATUS_NOT_A_NUMBER = 5,
    // No such side.
    FLANGEWAY_STATUS_SIDE = 6,
    // No such creep law.
    FLANGEWAY_STATUS_LAW = 7,
    // No such slot.
    FLANGEWAY_STATUS_SLOT = 8,
    // The table was not loaded, or was moved after it was loaded.
    FLANGEWAY_STATUS_NOT_LOADED = 9,
    // The image does not begin as a contact table does.
    FLANGEWAY_STATUS_TABLE_MAGIC = 16,
    // The image is of a format version that this library does not read.
    FLANGEWAY_STATUS_TABLE_VERSION = 17,
    // The image is shorter or longer than it says.
    FLANGEWAY_STATUS_TABLE_LENGTH = 18,
    // The image's checksum does not fit its bytes.
    FLANGEWAY_STATUS_TABLE_CHECKSUM = 19,
    // The image's header, axes, maps or records hold what no table may hold.
    FLANGEWAY_STATUS_TABLE_CONTENT = 20,
};
#ifndef __cplusplus
typedef int32_t flangeway_status;
#endif // __cplusplus

// A wheel of the wheelset.
enum flangeway_side
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    // The wheel at positive y.
    FLANGEWAY_SIDE_RIGHT = 0,
    // The wheel at negative y.
    FLANGEWAY_SIDE_LEFT = 1,
};
#ifndef __cplusplus
typedef int32_t flangeway_side;
#endif // __cplusplus

// How creep forces follow from creepages.
enum flangeway_creep_law
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    // Kalker's linear theory, without a limit.
    FLANGEWAY_CREEP_LAW_KALKER = 0,
    // Kalker's linear theory with the saturation of Shen, Hedrick and Elkins.
    FLANGEWAY_CREEP_LAW_SHEN_HEDRICK_ELKINS = 1,
    // Polach's closed form.
    FLANGEWAY_CREEP_LAW_POLACH = 2,
    // FASTSIM on 10 by 10 elements.
    FLANGEWAY_CREEP_LAW_FASTSIM10 = 3,
    // FASTSIM on 20 by 20 elements.
    FLANGEWAY_CREEP_LAW_FASTSIM20 = 4,
};
#ifndef __cplusplus
typedef int32_t flangeway_creep_law;
#endif // __cplusplus

// Region of the wheel profile.
enum flangeway_slot
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    // The tread.
    FLANGEWAY_SLOT_TREAD = 0,
    // Between tread and flange.
    FLANGEWAY_SLOT_FLANGE_ROOT = 1,
    // The flange.
    FLANGEWAY_SLOT_FLANGE = 2,
};
#ifndef __cplusplus
typedef int32_t flangeway_slot;
#endif // __cplusplus

// Bits of `flags`.
enum flangeway_flag
#ifdef __cplusplus
  : uint32_t
#endif // __cplusplus
 {
    // The lateral displacement lies outside the table: its edge answers.
    FLANGEWAY_FLAG_CLAMPED_LATERAL = 1,
    // The yaw lies outside the table: its edge answers.
    FLANGEWAY_FLAG_CLAMPED_YAW = 2,
    // The roll lies outside the table; little is lost.
    FLANGEWAY_FLAG_CLAMPED_ROLL = 4,
    // The vertical coordinate lies outside the table: the indentation is extrapolated.
    FLANGEWAY_FLAG_CLAMPED_VERTICAL = 8,
    // Yaw or roll is beyond 0.125 rad: the answer is that of the limit.
    FLANGEWAY_FLAG_ANGLE_LIMITED = 16,
    // A coordinate of the pose is NaN, infinite or beyond 1000: there are no contacts.
    FLANGEWAY_FLAG_INVALID_INPUT = 32,
    // Wheel and rail are nearly conformal somewhere: ellipse and stiffness follow the solver's policy.
    FLANGEWAY_FLAG_CONFORMAL = 64,
};
#ifndef __cplusplus
typedef uint32_t flangeway_flag;
#endif // __cplusplus

// A loaded table. Plain memory of the caller's (static, on the stack or the heap) which needs no release; it points
// into the image and must not be moved or copied after it was loaded.
typedef struct {
    // Not for the caller.
    uint64_t words[FLANGEWAY_TABLE_WORDS];
} flangeway_table;

// Pose of the wheelset in the track frame; all zero is centred with the axle at nominal radius above the rails.
typedef struct {
    // Lateral displacement, positive to the right, m.
    double lateral;
    // Yaw (angle of attack) about z, positive turns x towards y, rad.
    double yaw;
    // Vertical displacement, positive down, m.
    double vertical;
    // Roll about x, positive moves the right wheel down, rad; applied before yaw.
    double roll;
} flangeway_pose;

// One contact between wheel and rail, in the track frame.
typedef struct {
    // Normal force, N.
    float normal_force;
    // Indentation along the common normal, m.
    float indentation;
    // Contact point x, y, z, m.
    float position[3];
    // Contact angle: slope angle dz/dy of the common tangent, rad; negative on the right rail's gauge side.
    float angle;
    // Rolling radius, m.
    float rolling_radius;
    // Wheel-profile coordinate: lateral distance from the tape circle, positive outwards, m.
    float wheel_coordinate;
    // Semi-axes of the contact ellipse along x and across, m.
    float semi_axes[2];
    // Curvature of the wheel profile, 1/m.
    float wheel_curvature;
    // Curvature of the rail profile, 1/m.
    float rail_curvature;
    // Region of the wheel profile, a `flangeway_slot`.
    int32_t slot;
} flangeway_contact;

// Contacts of one wheel: those that carry force, in the order of their slots.
typedef struct {
    // The first `count` are contacts, the others all zero.
    flangeway_contact contact[FLANGEWAY_SLOTS];
    // Contacts, 0 to 3.
    int32_t count;
    // Remarks about the lookup, bits of `flangeway_flag`.
    uint32_t flags;
} flangeway_wheel_contacts;

// A wheel to look up.
typedef struct {
    // Pose of its wheelset.
    flangeway_pose pose;
    // A `flangeway_side`.
    int32_t side;
    // Not used; there so that the size is the same everywhere.
    int32_t reserved;
} flangeway_wheel;

// What a table says of itself.
typedef struct {
    // Track gauge, m.
    double gauge;
    // Rolling radius at the tape circle, right and left wheel, m.
    double nominal_radius[2];
    // Distance of the tape circle from the wheelset's centre, right and left wheel, m.
    double lateral_position[2];
    // Young's modulus of wheel and rail, Pa.
    double young_modulus;
    // Poisson's ratio of wheel and rail.
    double poisson_ratio;
    // Median of the measured force error, relative; zero if nobody measured.
    double force_error_median;
    // 95 % quantile of the measured force error.
    double force_error_p95;
} flangeway_info;

// A contact's ellipse and normal force, as the creep laws take it.
typedef struct {
    // Semi-axes along x and across, m.
    float semi_axes[2];
    // Normal force, N.
    float normal_force;
} flangeway_patch;

// Elastic constants of wheel and rail.
typedef struct {
    // Shear modulus, Pa.
    float shear_modulus;
    // Poisson's ratio.
    float poisson_ratio;
} flangeway_elasticity;

// Creepages: velocity of the wheel relative to the rail at the contact over speed.
typedef struct {
    // Longitudinal.
    float longitudinal;
    // Lateral, along the contact's tangent, positive to the right.
    float lateral;
    // Spin about the contact's normal (down), positive from x towards y, 1/m.
    float spin;
} flangeway_creepage;

// Forces on the wheel in the contact plane.
typedef struct {
    // Longitudinal force, positive forward, N.
    float longitudinal;
    // Lateral force along the contact's tangent, positive to the right, N.
    float lateral;
    // Spin moment about the contact's normal (down), N m.
    float spin_moment;
} flangeway_creep_force;

// Motion of the wheelset as far as its contacts move by it.
typedef struct {
    // Pose in the track frame.
    flangeway_pose pose;
    // Rates of the pose, seen in the track frame that moves along: m/s, rad/s.
    flangeway_pose rates;
    // Speed along the track, forward, m/s.
    double speed;
    // Angular speed about the axle, positive when rolling forward, rad/s; speed / nominal radius when free.
    double spin;
    // Curvature of the track, positive in a right-hand curve, 1/m.
    double track_curvature;
} flangeway_motion;

// Friction that may fall with slip velocity w (m/s): coefficient ((1 - limit_ratio) exp(-decay w) + limit_ratio).
// Coulomb's constant friction has limit_ratio 1 and decay 0.
typedef struct {
    // Coefficient without slip.
    float coefficient;
    // Coefficient at infinite slip over that without.
    float limit_ratio;
    // How fast it falls, s/m.
    float decay;
} flangeway_friction;

// What one wheel's contacts do.
typedef struct {
    // Its contacts.
    flangeway_wheel_contacts contacts;
    // Creepages of each contact, as many as contacts.
    flangeway_creepage creepages[FLANGEWAY_SLOTS];
    // Creep forces of each contact.
    flangeway_creep_force creep_forces[FLANGEWAY_SLOTS];
    // Guiding force Y on the rail, positive outwards, N.
    double guiding_force;
    // Wheel load Q on the rail, N.
    double wheel_load;
    // Y / Q; zero without load.
    double derailment_quotient;
    // Wear index T gamma: work of the creep forces a metre of track, N.
    double wear_index;
} flangeway_wheel_forces;

// Forces of both wheels' contacts on the wheelset, track frame.
typedef struct {
    // Force, N.
    double force[3];
    // Moment about the wheelset's centre, N m.
    double moment[3];
    // Right wheel, left wheel.
    flangeway_wheel_forces wheel[2];
} flangeway_wheelset_forces;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// FLANGEWAY_INTERFACE_VERSION of the library.
uint32_t flangeway_interface_version(void);

// Format version of the tables that the library reads.
uint32_t flangeway_format_version(void);

// The library's version, as in "0.1.0".
const char *flangeway_version(void);

// Asks for the records of a pose, so that they are in the cache when the lookup comes, while the caller does other work.
int32_t flangeway_prefetch(const flangeway_table *table,
                           int32_t wheel_side,
                           const flangeway_pose *pose);

// Contacts of a wheel (a `flangeway_side`) at a pose. The same work for every pose. A pose with NaN, infinity or a
// coordinate beyond 1000 gives FLANGEWAY_STATUS_NOT_A_NUMBER, no contacts and a flag.
int32_t flangeway_contacts(const flangeway_table *table,
                           int32_t wheel_side,
                           const flangeway_pose *pose,
                           flangeway_wheel_contacts *contacts);

// Contacts of `count` wheels, as `flangeway_contacts` gives them, records asked for ahead of the wheel in hand.
// `capacity` is how many wheels' contacts fit at `contacts`. If a pose is no number, the others are answered
// all the same and FLANGEWAY_STATUS_NOT_A_NUMBER returned; if a side is none, nothing is written.
int32_t flangeway_contacts_many(const flangeway_table *table,
                                const flangeway_wheel *wheels,
                                size_t count,
                                flangeway_wheel_contacts *contacts,
                                size_t capacity);

// A status in words; "no such status" for a number that is none. The text is constant and never NULL.
const char *flangeway_status_text(int32_t status);

// Checks the table image at `image` (read through once, nothing is allocated) and makes `table` a view of it.
// `table_size` is sizeof(flangeway_table): another header than this library's is noticed.
//
// The image needs no alignment; on a multiple of 64 bytes lookups are fastest. It must stay unchanged where it is while
// the table is used. After an error the table is not loaded.
int32_t flangeway_table_load(flangeway_table *table,
                             size_t table_size,
                             const void *image,
                             size_t length);

// Writes what is wrong with the image at `image` as text into `text`, at most `capacity` bytes with the closing zero;
// an empty text if nothing is. Returns what `flangeway_table_load` would, or FLANGEWAY_STATUS_SHORT_BUFFER if the text
// was cut.
int32_t flangeway_table_problem(const void *image,
                                size_t length,
                                char *text,
                                size_t capacity);

// Writes what a loaded table says of itself.
int32_t flangeway_table_info(const flangeway_table *table, flangeway_info *info);

// Forces of a contact by a creep law (a `flangeway_creep_law`), with a coefficient of friction. An input that is no
// number gives FLANGEWAY_STATUS_NOT_A_NUMBER and zero forces; a semi-axis, force or friction that is not positive gives
// zero forces.
int32_t flangeway_creep_forces(int32_t creep_law,
                               const flangeway_patch *patch,
                               const flangeway_elasticity *elastic,
                               const flangeway_creepage *creepage,
                               float friction,
                               flangeway_creep_force *forces);

// Creepages of a contact of a wheel in motion. A motion or contact that is no number, or beyond 1e6, gives
// FLANGEWAY_STATUS_NOT_A_NUMBER and none.
int32_t flangeway_creepages(const flangeway_table *table,
                            int32_t wheel_side,
                            const flangeway_motion *motion,
                            const flangeway_contact *contact,
                            flangeway_creepage *creepage);

// All forces between a wheelset and its rails: contacts of both wheels, creepages, creep forces by a law (a
// `flangeway_creep_law`), and their wrench on the wheelset. Material is the table's. A motion that is no number, or
// beyond 1000 in the pose and 1e6 elsewhere, gives FLANGEWAY_STATUS_NOT_A_NUMBER and no forces.
int32_t flangeway_wheelset(const flangeway_table *table,
                           const flangeway_motion *motion,
                           int32_t creep_law,
                           const flangeway_friction *friction,
                           flangeway_wheelset_forces *forces);

// Nadal's limit of Y / Q for a flange of contact angle `angle` (rad, its sign does not matter) and a coefficient of
// friction. NaN or infinity gives FLANGEWAY_STATUS_NOT_A_NUMBER and zero.
int32_t flangeway_nadal_limit(double angle,
                              double friction,
                              double *limit);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FLANGEWAY_H */
