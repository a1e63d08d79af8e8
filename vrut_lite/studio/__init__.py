"""Pictures of skies and scenes without a window: for commands, the window and notebooks."""
