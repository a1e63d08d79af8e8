"""`vrut-lite bench`: run time against error of the host and its modules, beside others' figures."""
