//! Real roots of polynomials of degree two to four.
