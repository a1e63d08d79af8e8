"""The scene in a headset, by OpenXR."""
