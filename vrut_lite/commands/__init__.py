"""The commands of `vrut-lite`; others are contributed by entry point `vrut_lite.commands`."""
