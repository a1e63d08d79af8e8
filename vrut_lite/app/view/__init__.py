"""The picture, the camera in the user's hands, and what is drawn over the picture."""
