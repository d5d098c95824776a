// The same spheres and rays through Embree 3: user geometry with a callback in double precision, which is faster than
// its built-in spheres. Reads what `dump` wrote: `embree SPHERES RAYS [passes]`, arrays of float.
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

struct Ball { float x, y, z, r; };
struct Line { float o[3], d[3]; };

static std::vector<Ball> balls;

template <class T> static std::vector<T> read(const char* path) {
  std::vector<T> all;
  FILE* file = std::fopen(path, "rb");
  if (!file) { std::perror(path); std::exit(1); }
  for (T one; std::fread(&one, sizeof one, 1, file) == 1;) all.push_back(one);
  std::fclose(file);
  return all;
}

// Seconds of this thread on a processor.
static double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

static void bounds(const RTCBoundsFunctionArguments* a) {
  const Ball& b = balls[a->primID];
  auto down = [](double x) { return std::nextafterf(float(x), -INFINITY); };
  auto up = [](double x) { return std::nextafterf(float(x), INFINITY); };
  *a->bounds_o = {down(double(b.x) - b.r), down(double(b.y) - b.r), down(double(b.z) - b.r), 0,
                  up(double(b.x) + b.r), up(double(b.y) + b.r), up(double(b.z) + b.r), 0};
}

// The first crossing in [from, to), by way of the closest approach; negative when there is none.
static double crossing(const Ball& b, const double o[3], const double d[3], double from, double to) {
  double w[3] = {o[0] - b.x, o[1] - b.y, o[2] - b.z};
  double scale = 1 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  double closest = -(w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) * scale, square = 0;
  for (int k = 0; k < 3; k++) { double m = w[k] + closest * d[k]; square += m * m; }
  double depth = double(b.r) * b.r - square;
  if (depth < 0) return -1;
  double half = std::sqrt(depth * scale);
  double t = closest - half >= from ? closest - half : closest + half;
  return t >= from && t < to ? t : -1;
}

static void hit(const RTCIntersectFunctionNArguments* a) {
  unsigned n = a->N;
  RTCRayN* ray = RTCRayHitN_RayN(a->rayhit, n);
  RTCHitN* found = RTCRayHitN_HitN(a->rayhit, n);
  for (unsigned i = 0; i < n; i++) {
    if (a->valid[i] != -1) continue;
    double o[3] = {RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i)};
    double d[3] = {RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i)};
    double t = crossing(balls[a->primID], o, d, RTCRayN_tnear(ray, n, i), RTCRayN_tfar(ray, n, i));
    if (t < 0) continue;
    RTCRayN_tfar(ray, n, i) = float(t);
    RTCHitN_geomID(found, n, i) = a->geomID;
    RTCHitN_primID(found, n, i) = a->primID;
  }
}

template <class Work> static void measure(const char* name, size_t rays, int passes, Work work) {
  double best = INFINITY;
  size_t hits = 0;
  for (int pass = 0; pass < passes; pass++) {
    double start = now();
    hits = work();
    best = std::min(best, now() - start);
  }
  std::printf("  embree %-16s %7.2f Mrays/s  hits=%zu\n", name, rays / best * 1e-6, hits);
}

int main(int count, char** arguments) {
  if (count < 3) return 2;
  balls = read<Ball>(arguments[1]);
  std::vector<Line> lines = read<Line>(arguments[2]);
  int passes = count > 3 ? std::atoi(arguments[3]) : 3;
  RTCDevice device = rtcNewDevice("threads=1,user_threads=1");
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(balls.size()));
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, hit);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  double start = now();
  rtcCommitScene(scene);
  std::printf("  embree build %.1f ms\n", (now() - start) * 1e3);

  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  auto aim = [&](const Line& l, auto&& set) {
    set(l.o[0], l.o[1], l.o[2], l.d[0], l.d[1], l.d[2]);
  };
  for (bool coherent : {false, true}) {
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    measure(coherent ? "1, coherent" : "1, incoherent", lines.size(), passes, [&] {
      size_t hits = 0;
      for (const Line& l : lines) {
        RTCRayHit r = {};
        aim(l, [&](float a, float b, float c, float d, float e, float f) {
          r.ray.org_x = a; r.ray.org_y = b; r.ray.org_z = c; r.ray.dir_x = d; r.ray.dir_y = e; r.ray.dir_z = f;
        });
        r.ray.tfar = INFINITY; r.ray.mask = ~0u; r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &r);
        hits += r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
      }
      return hits;
    });
    measure(coherent ? "16, coherent" : "16, incoherent", lines.size() / 16 * 16, passes, [&] {
      size_t hits = 0;
      alignas(64) int valid[16];
      std::fill(valid, valid + 16, -1);
      for (size_t first = 0; first + 16 <= lines.size(); first += 16) {
        RTCRayHit16 r = {};
        for (int i = 0; i < 16; i++) {
          aim(lines[first + i], [&](float a, float b, float c, float d, float e, float f) {
            r.ray.org_x[i] = a; r.ray.org_y[i] = b; r.ray.org_z[i] = c;
            r.ray.dir_x[i] = d; r.ray.dir_y[i] = e; r.ray.dir_z[i] = f;
          });
          r.ray.tfar[i] = INFINITY; r.ray.mask[i] = ~0u; r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene, &context, &r);
        for (int i = 0; i < 16; i++) hits += r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      }
      return hits;
    });
  }
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
