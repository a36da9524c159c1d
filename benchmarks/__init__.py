"""Side by side with OMPL and grid search: ``python -m benchmarks`` (``make bench``)."""
