"""What skies are compared with and by: Bruneton's 2016 evaluation of clear sky models, rebuilt."""
