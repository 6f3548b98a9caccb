# The page that describes the interface for programs; what is in it is English in every language.

api-title = For programs
api-about = What programs can ask hallsweep for, and what they get; for generators of clients:
api-subjects = Subjects
api-shapes = Shapes
api-for = For
api-name = Name
api-body = Body
api-answer = Answer
api-problems = What may go wrong
