/* The two steps of scheme 1 as one would write them in C for speed, on open ends and from level n to n + 1.

   Ghosted arrays h, u have nx + 2 entries, all others one per cell. The arithmetic is that of kinsim: what stands here
   is compared with it to 1e-12 before anything is timed. */

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static double clamp(double x, double low, double high) { return fmin(high, fmax(x, low)); }

/* u = q/h, ghosts; returns the largest |u| + c. */
static double begin(long nx, const double *h0, const double *q0, double beta, double *h, double *u)
{
    double top = 0.0;
    for (long i = 0; i < nx; i++) {
        h[i + 1] = h0[i];
        u[i + 1] = q0[i] / fmax(h0[i], 1e-300);
        top = fmax(top, fabs(u[i + 1]) + sqrt(2.0 * beta * h0[i]));
    }
    h[0] = h[1], u[0] = u[1], h[nx + 1] = h[nx], u[nx + 1] = u[nx];
    return top;
}

static double sliding(double below, double above, double u, double s, double R, double beta, double dx)
{
    double still = clamp(beta * ((above - below) / (2.0 * dx)), s - R, s + R), g = u > 0.0 ? s - R : s + R;
    return u == 0.0 ? still : g;
}

/* ---- the density carried along ---- */

struct sums { double p1, p2, n1, n2; };

static struct sums fill(long n, const double *restrict xi, const double *restrict w1, const double *restrict w2,
                        double h, double u, double beta, double *restrict M)
{
    struct sums a = {0.0, 0.0, 0.0, 0.0};
    double square = 2.0 * beta * h, scale = 1.0 / (PI * beta);
    for (long j = 0; j < n / 2; j++) {
        double w = xi[j] - u, m = scale * sqrt(fmax(square - w * w, 0.0));
        M[j] = m, a.n1 += w1[j] * m, a.n2 += w2[j] * m;
    }
    for (long j = n / 2; j < n; j++) {
        double w = xi[j] - u, m = scale * sqrt(fmax(square - w * w, 0.0));
        M[j] = m, a.p1 += w1[j] * m, a.p2 += w2[j] * m;
    }
    return a;
}

/* room: 2 (nx + 2) for h and u, 3 n for rows of M, 3 n + 2 for a row between zeros. w1, w2: dxi xi, dxi xi^2. */
double carried(long nx, long n, const double *h0, const double *q0, const double *xi, const double *w1,
               const double *w2, double beta, double s, double R, double dx, double dt, double *room,
               double *h1, double *q1, double *f)
{
    double *h = room, *u = h + nx + 2, *rows = u + nx + 2, *t = rows + 3 * n + n + 1;
    double lam = dt / dx, dxi = xi[1] - xi[0], top = begin(nx, h0, q0, beta, h, u);
    memset(rows + 3 * n, 0, (3 * n + 2) * sizeof(double));
    struct sums before = fill(n, xi, w1, w2, h[0], u[0], beta, rows);
    struct sums here = fill(n, xi, w1, w2, h[1], u[1], beta, rows + n);
    for (long i = 0; i < nx; i++) {
        const double *restrict A = rows + (i % 3) * n, *restrict M = rows + ((i + 1) % 3) * n;
        double *restrict B = rows + ((i + 2) % 3) * n, *restrict out = f + i * n;
        struct sums after = fill(n, xi, w1, w2, h[i + 2], u[i + 2], beta, B);
        h1[i] = h[i + 1] - lam * ((here.p1 + after.n1) - (before.p1 + here.n1));
        double J = dt * sliding(h[i], h[i + 2], u[i + 1], s, R, beta, dx) * h1[i];
        q1[i] = q0[i] - lam * ((here.p2 + after.n2) - (before.p2 + here.n2)) + J;
        for (long j = 0; j < n / 2; j++) t[j] = M[j] - lam * xi[j] * (B[j] - M[j]);
        for (long j = n / 2; j < n; j++) t[j] = M[j] - lam * xi[j] * (M[j] - A[j]);
        double distance = h1[i] > 0.0 ? fmin(fabs(J) / h1[i] / dxi, n) : 0.0;
        long whole = (long)distance;
        double theta = distance - whole;
        const double *near = J < 0.0 ? t + whole : t - whole, *far = J < 0.0 ? near + 1 : near - 1;
        for (long j = 0; j < n; j++) out[j] = (1.0 - theta) * near[j] + theta * far[j];
        before = here, here = after;
    }
    return top;
}

/* ---- closed form ---- */

static double arccos(double x) /* of 0 <= x <= 1; by half of the angle above 1/2 */
{
    int far = x > 0.5;
    double z = far ? 0.5 * (1.0 - x) : x * x, root = sqrt(z), y = far ? root : x, p = 0.028757851367421566;
    p = p * z - 0.014851887071247204, p = p * z + 0.01740087944269402, p = p * z + 0.005457506718640358;
    p = p * z + 0.01032281435018578, p = p * z + 0.011479177415184906, p = p * z + 0.013971212973552933;
    p = p * z + 0.017352392720869973, p = p * z + 0.02237217294214989, p = p * z + 0.030381944138531247;
    p = p * z + 0.04464285714635543, p = p * z + 0.07499999999998433, p = p * z + 0.16666666666666669;
    double near = y + y * z * p;
    return far ? 2.0 * near : 0.5 * PI - near;
}

static void moments(long m, const double *restrict h, const double *restrict u, double beta, double *restrict P1,
                    double *restrict P2, double *restrict N1, double *restrict N2)
{
    for (long i = 0; i < m; i++) {
        double c = sqrt(2.0 * beta * h[i]), speed = fabs(u[i]), a = fmin(speed / fmax(c, 1e-300), 1.0);
        double r = sqrt((1.0 - a) * (1.0 + a)), angle = arccos(a), weight = 2.0 / PI * h[i];
        double p0 = 0.5 * (angle - a * r), p1 = r * r * r / 3.0;
        double p2 = 0.125 * (angle + a * r * (1.0 - 2.0 * a * a));
        double m1 = fmax(weight * (c * p1 - speed * p0), 0.0);
        double m2 = fmax(weight * (speed * speed * p0 - 2.0 * speed * c * p1 + c * c * p2), 0.0);
        double all1 = h[i] * u[i], all2 = h[i] * u[i] * u[i] + 0.5 * beta * h[i] * h[i];
        double up = u[i] > 0.0 ? 1.0 : 0.0;
        P1[i] = m1 + up * all1, P2[i] = m2 + up * (all2 - 2.0 * m2);
        N1[i] = all1 - P1[i], N2[i] = all2 - P2[i];
    }
}

/* room: 6 (nx + 2) for h, u and the half-range moments of each cell. */
double closed(long nx, const double *h0, const double *q0, double beta, double s, double R, double dx, double dt,
              double *room, double *restrict h1, double *restrict q1)
{
    long m = nx + 2;
    double *restrict h = room, *restrict u = h + m, *restrict P1 = u + m, *restrict P2 = P1 + m;
    double *restrict N1 = P2 + m, *restrict N2 = N1 + m;
    double lam = dt / dx, top = begin(nx, h0, q0, beta, h, u);
    moments(m, h, u, beta, P1, P2, N1, N2);
    for (long i = 0; i < nx; i++) {
        h1[i] = h[i + 1] - lam * ((P1[i + 1] + N1[i + 2]) - (P1[i] + N1[i + 1]));
        double J = dt * sliding(h[i], h[i + 2], u[i + 1], s, R, beta, dx) * h1[i];
        q1[i] = q0[i] - lam * ((P2[i + 1] + N2[i + 2]) - (P2[i] + N2[i + 1])) + J;
    }
    return top;
}
