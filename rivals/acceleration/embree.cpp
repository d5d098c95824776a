// The same shapes and rays through Embree 3: user geometry with a callback in double precision, which is faster than
// its built-in spheres. Reads what `dump` wrote and appends the nearest parameters (NaN: nothing) for `judge`:
// `embree sphere|torus SHAPES RAYS ANSWERS [passes]`.
#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

struct Sphere { float x, y, z, r; };
struct Torus { double center[3], axis[3], major, minor; };
struct Line { float o[3], d[3]; };

static std::vector<Sphere> spheres;
static std::vector<Torus> tori;
static long long memory;

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

static void box(const Sphere& s, double low[3], double high[3]) {
  const float center[3] = {s.x, s.y, s.z};
  for (int k = 0; k < 3; k++) { low[k] = double(center[k]) - s.r; high[k] = double(center[k]) + s.r; }
}

static void box(const Torus& t, double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) {
    double reach = t.major * std::sqrt(std::fmax(0, 1 - t.axis[k] * t.axis[k])) + t.minor;
    low[k] = t.center[k] - reach * (1 + 1e-12);
    high[k] = t.center[k] + reach * (1 + 1e-12);
  }
}

// The first crossing in [from, to), by way of the closest approach; negative when there is none.
static double crossing(const Sphere& s, const double o[3], const double d[3], double from, double to) {
  double w[3] = {o[0] - s.x, o[1] - s.y, o[2] - s.z};
  double scale = 1 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  double closest = -(w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) * scale, square = 0;
  for (int k = 0; k < 3; k++) { double m = w[k] + closest * d[k]; square += m * m; }
  double depth = double(s.r) * s.r - square;
  if (depth < 0) return -1;
  double half = std::sqrt(depth * scale);
  double t = closest - half >= from ? closest - half : closest + half;
  return t >= from && t < to ? t : -1;
}

// The root of x^4 + p x^2 + q x + s (quartic) or of its derivative in [a, b], where it changes its sign once, from
// that of `first`: Newton's method, halving where that leaves the bracket.
template <bool quartic> static double root(double a, double b, double first, double p, double q, double s) {
  double x = 0.5 * (a + b);
  for (int i = 0; i < 60; i++) {
    double value = quartic ? ((x * x + p) * x + q) * x + s : (4 * x * x + 2 * p) * x + q;
    double slope = quartic ? (4 * x * x + 2 * p) * x + q : 12 * x * x + 2 * p;
    ((value < 0) == (first < 0) ? a : b) = x;
    double next = x - value / slope;
    if (!(next > a && next < b)) next = 0.5 * (a + b);
    if (std::fabs(next - x) <= 2e-16 * std::fabs(next) + 1e-300 || next == a || next == b) return next;
    x = next;
  }
  return x;
}

// The same for a torus: the quartic about the closest approach to the centre, between sphere and slab around it, its
// roots bracketed by those of its derivative.
static double crossing(const Torus& torus, const double o[3], const double d[3], double from, double to) {
  const double *n = torus.axis, R = torus.major, r = torus.minor;
  double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), inverse = 1 / length, w[3], e[3];
  double shift = 0, ww = 0, wn = 0, en = 0;
  for (int k = 0; k < 3; k++) { w[k] = o[k] - torus.center[k]; e[k] = d[k] * inverse; shift -= w[k] * e[k]; }
  for (int k = 0; k < 3; k++) { w[k] += shift * e[k]; ww += w[k] * w[k]; wn += w[k] * n[k]; en += e[k] * n[k]; }
  double room = (R + r) * (R + r) - ww;
  if (room <= 0) return -1;
  double half = std::sqrt(room) * (1 + 1e-12);
  double a = std::fmax(-half, from * length - shift), b = std::fmin(half, to * length - shift);
  if (a >= b) return -1;
  if (std::fabs(en) > 1e-9) {
    double in = (-r - wn) / en, out = (r - wn) / en;
    if (in > out) std::swap(in, out);
    a = std::fmax(a, in - 1e-9 * half);
    b = std::fmin(b, out + 1e-9 * half);
    if (a >= b) return -1;
  } else if (std::fabs(wn) - std::fabs(en) * half > r * (1 + 1e-9)) {
    return -1;
  }
  double k = ww + R * R - r * r;
  double p = 2 * k - 4 * R * R * (1 - en * en), q = 8 * R * R * wn * en, s = k * k - 4 * R * R * (ww - wn * wn);
  auto value = [&](double x) { return ((x * x + p) * x + q) * x + s; };
  auto slope = [&](double x) { return (4 * x * x + 2 * p) * x + q; };
  // Between inflections the derivative is monotonic.
  double ends[4], inflection = p < 0 ? std::sqrt(-p / 6) : INFINITY;
  int count = 0;
  ends[count++] = a;
  for (double x : {-inflection, inflection}) if (x > a && x < b) ends[count++] = x;
  ends[count++] = b;
  double x0 = a, f0 = value(a), g0 = slope(a);
  for (int i = 1; i < count; i++) {
    double g1 = slope(ends[i]);
    if ((g0 < 0) != (g1 < 0)) {
      double x1 = root<false>(ends[i - 1], ends[i], g0, p, q, s), f1 = value(x1);
      if ((f0 < 0) != (f1 < 0)) return (root<true>(x0, x1, f0, p, q, s) + shift) * inverse;
      x0 = x1;
      f0 = f1;
    }
    g0 = g1;
  }
  return (f0 < 0) != (value(b) < 0) ? (root<true>(x0, b, f0, p, q, s) + shift) * inverse : -1;
}

template <class Shape, std::vector<Shape>& shapes> static void bounds(const RTCBoundsFunctionArguments* a) {
  double low[3], high[3];
  box(shapes[a->primID], low, high);
  auto down = [](double x) { return std::nextafterf(float(x), -INFINITY); };
  auto up = [](double x) { return std::nextafterf(float(x), INFINITY); };
  *a->bounds_o = {down(low[0]), down(low[1]), down(low[2]), 0, up(high[0]), up(high[1]), up(high[2]), 0};
}

template <class Shape, std::vector<Shape>& shapes> static void hit(const RTCIntersectFunctionNArguments* a) {
  unsigned n = a->N;
  RTCRayN* ray = RTCRayHitN_RayN(a->rayhit, n);
  RTCHitN* found = RTCRayHitN_HitN(a->rayhit, n);
  for (unsigned i = 0; i < n; i++) {
    if (a->valid[i] != -1) continue;
    double o[3] = {RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i)};
    double d[3] = {RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i)};
    double t = crossing(shapes[a->primID], o, d, RTCRayN_tnear(ray, n, i), RTCRayN_tfar(ray, n, i));
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
  std::printf("embree %-24s %8.3f Mrays/s  hits=%zu\n", name, rays / best * 1e-6, hits);
  std::fflush(stdout);
}

static bool count_memory(void*, ssize_t bytes, bool) { memory += bytes; return true; }

int main(int count, char** arguments) {
  if (count < 5) return 2;
  bool torus = arguments[1] == std::string("torus");
  if (torus) tori = read<Torus>(arguments[2]); else spheres = read<Sphere>(arguments[2]);
  size_t shapes = torus ? tori.size() : spheres.size();
  std::vector<Line> lines = read<Line>(arguments[3]);
  int passes = count > 5 ? std::atoi(arguments[5]) : 3;
  // As Embree advises.
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _mm_setcsr(_mm_getcsr() | 0x40);
  RTCDevice device = rtcNewDevice("threads=1,user_threads=1");
  rtcSetDeviceMemoryMonitorFunction(device, count_memory, nullptr);
  RTCScene scene = nullptr;
  double least = INFINITY;
  for (int pass = 0; pass < passes; pass++) {
    if (pass > 0) rtcReleaseScene(scene);
    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(shapes));
    rtcSetGeometryBoundsFunction(geometry, torus ? bounds<Torus, tori> : bounds<Sphere, spheres>, nullptr);
    rtcSetGeometryIntersectFunction(geometry, torus ? hit<Torus, tori> : hit<Sphere, spheres>);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    memory = 0;
    double start = now();
    rtcCommitScene(scene);
    least = std::min(least, now() - start);
  }
  std::printf("embree build %27.1f ms  %.1f bytes/shape\n", least * 1e3, double(memory) / shapes);

  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  auto aim = [&](const Line& l, auto&& set) { set(l.o[0], l.o[1], l.o[2], l.d[0], l.d[1], l.d[2]); };
  FILE* answers = std::fopen(arguments[4], "wb");
  if (!answers) { std::perror(arguments[4]); return 1; }
  std::vector<double> parameters(lines.size());
  for (bool coherent : {false, true}) {
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    measure(coherent ? "single, coherent" : "single, incoherent", lines.size(), passes, [&] {
      size_t hits = 0;
      for (size_t i = 0; i < lines.size(); i++) {
        RTCRayHit r = {};
        aim(lines[i], [&](float a, float b, float c, float d, float e, float f) {
          r.ray.org_x = a; r.ray.org_y = b; r.ray.org_z = c; r.ray.dir_x = d; r.ray.dir_y = e; r.ray.dir_z = f;
        });
        r.ray.tfar = INFINITY; r.ray.mask = ~0u; r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &r);
        bool found = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        parameters[i] = found ? double(r.ray.tfar) : NAN;
        hits += found;
      }
      return hits;
    });
    if (!coherent) std::fwrite(parameters.data(), sizeof(double), parameters.size(), answers);
    measure(coherent ? "packets of 16, coherent" : "packets of 16, incoherent", lines.size() / 16 * 16, passes, [&] {
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
  std::fclose(answers);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
