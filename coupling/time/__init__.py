"""Time integration: Newmark's method and exponential collocation, with one driver over both."""
