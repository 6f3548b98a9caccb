# What scripts say: a line each, and in it only values.

## attention

## console

## editor

## hall

## laboratory

## pallet

## photo

## replay

## roomba

## simulator

## time

## trees

## verdict
