// Form factors of flat polygons with nothing between them. F12 is the share of the light that leaves polygon 1, spread
// evenly over it and by Lambert's law over directions, which arrives at polygon 2. Host only, any thread, no state.
//
//   A1 F12 = ∫∫ cos θ1 cos θ2 / (π r²) dA2 dA1 = 1/(2π) ∮∮ ln r dr1 · dr2        m²
//
// The second form is Stokes' theorem twice (Sparrow 1963; Schröder and Hanrahan 1993, "On the form factor between two
// polygons", eq. 3). A polygon emits and receives at its front alone, the side from which its corners run counter-clockwise.
// What of either polygon is behind the other's plane is cut off first, so that cosines are never negative.
//
// Which of the two forms is taken, pair by pair:
// - By area, where each polygon is small beside its distance: a product of Gauss rules of 2, 4 or 6 points an axis. All
//   terms are positive, so nothing cancels, at any distance and however grazing.
// - By contour, where they are near or touch: edge_pair.h. Terms of both signs cancel down to A1 F12. Their rounding is
// known,
//   some 2⁻⁵¹ of the terms' sizes: of A1 F12 it is 1e-14 for squares side by side, 1e-10 where they meet at 179 degrees.
// - Where that is more than FORM_FACTOR_TOLERANCE, as for needles side by side, the polygon that is larger is halved, and
// both
//   halves are treated alike. Halves are rounder and, beside their size, farther away.
//
// Measured beside closed forms in 50 digits (tests/unit/test_form_factor.c): relative errors are 1e-11 and less where
// squares are near or touch, 2e-9 by area, and 7e-8 for needles of 1 : 10⁶. Corners that are rounded as they are turned can
// cost more: those 10⁴ sizes away and 10⁻⁵ above a horizon 1e-7. A pair takes 1 to 50 µs, needles up to 40 ms.
//
// Example: what of a lamp's light falls on a wall
//	const struct form_polygon lamp = {{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}, 4};
//	const struct form_polygon wall = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 4};
//	double error;
//	const double share = form_factor_exchange(&lamp, &wall, 0, &error) / form_factor_area(&lamp);
//	assert(fabs(share - 0.19982489569838) < 1e-12 && error < 1e-7);
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FORM_FACTOR_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FORM_FACTOR_H

#include <stdint.h>

#define FORM_FACTOR_CORNERS 6u // of a polygon, at most
#define FORM_FACTOR_TOLERANCE 2e-7 // relative error that is aimed at
#define FORM_FACTOR_PAIRS 8192u // of pieces that are looked at for one result, at most

// A flat convex polygon: its corners in metres. Corners may coincide.
struct form_polygon {
	double at[FORM_FACTOR_CORNERS][3];
	uint32_t corners; // 3 … FORM_FACTOR_CORNERS
};

// The polygon's area, m².
double form_factor_area(const struct form_polygon *polygon);

// A1 F12 = A2 F21, in m²: divided by form_factor_area of the one that emits, it is the form factor. The relative error aims
// at FORM_FACTOR_TOLERANCE, or the absolute one at `enough` m² if that is more; nearly coplanar neighbours, whose corners
// were rounded to float, cost less with 1e-12 of their area than with 0. `error` is the bound that was reached, in m², also
// of what rounding may leave below zero; it is above both aims where FORM_FACTOR_PAIRS did not suffice. What is behind
// within the rounding of the corners is behind: coplanar polygons have exactly 0, as those without an area have. Coordinates
// that are not finite give NaN and an infinite error.
double form_factor_exchange(const struct form_polygon *a, const struct form_polygon *b, double enough, double *error);

// The form factor from an element of area at `at` with the unit normal `normal` to what of the polygon is above its horizon
// (Lambert 1760; Baum, Rushmeier and Winget 1989, "Improving radiosity solutions through the use of analytically determined
// form-factors"). Below zero: the element is behind the polygon, and sees its back. Its absolute error is some 1e-15.
double form_factor_at(const double at[3], const double normal[3], const struct form_polygon *polygon);

#endif
