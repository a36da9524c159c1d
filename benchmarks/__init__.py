"""Compare with OMPL, grid search and hopsy: ``python -m benchmarks`` (``make bench``)."""
